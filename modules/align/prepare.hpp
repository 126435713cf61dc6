#pragma once

#include <vector>

#include <Eigen/Core>

#include "align/align_map.hpp"

namespace concord {

/// What alignment keeps of a map, as fine as it can be aligned: one that is too fine or too large for make_align_map is
/// taken in voxels of 0.05, 0.1, 0.2 or 0.4 m, the first that will do. Refused: see make_align_map and resample.
[[nodiscard]] Result<AlignMap> prepare_map(const BrickMap& map, double resolution, int threads);

/// The same of a cloud that nothing is known of, which says itself how dense it is (see prepare_cloud).
/// @pre all points are finite and within kMaxSurfaceReach.
[[nodiscard]] Result<AlignMap> prepare_map(std::vector<Eigen::Vector3f> cloud, int threads);

}  // namespace concord
