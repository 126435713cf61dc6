#pragma once

#include "merge_cases.hpp"

namespace concord::bench {

/// What is measured on one case, one thread, Concord and the papers' loop in one run.
struct MergeFigures {
  double full_ratio = 0.0;     ///< time of the papers' loop over both submaps / time of `compose`
  double update_ratio = 0.0;   ///< the same time / time to take in a change of 1 % of B's bricks that lie together
  double memory_ratio = 0.0;   ///< bytes per known voxel: the papers' two trees / both layers and the merged map
  double mvoxels_per_s = 0.0;  ///< known voxels of both submaps / time of `compose`, in millions
  double naive_mvoxels_per_s = 0.0;  ///< the same for the papers' loop
  double voxels_per_brick = 0.0;     ///< known voxels / bricks of both submaps

  std::size_t voxels = 0;  ///< known voxels of both submaps
  double update_ms = 0.0;
  std::size_t update_bricks = 0;  ///< bricks of B that change
  double bytes_per_voxel = 0.0;
  double naive_bytes_per_voxel = 0.0;
};

[[nodiscard]] MergeFigures measure(MergeCase& merge_case);

}  // namespace concord::bench
