#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "core/error.hpp"
#include "core/lattice.hpp"

namespace concord {

/// Gathers voxels from parts that may overlap, as runs along z, and never more than a stated number.
class VoxelRuns {
 public:
  /// At most `most` different voxels.
  explicit VoxelRuns(std::int64_t most) : most_(most) {}

  /// Adds the voxels (x, y, first) to (x, y, last). False when that is too many for sure: then stop.
  [[nodiscard]] bool add(std::int32_t x, std::int32_t y, std::int32_t first, std::int32_t last);
  /// Ends a part. False when the parts together are too many for sure: then stop.
  [[nodiscard]] bool end_part();
  /// How many different voxels there are, without taking memory for them. Refused: over `most` (kTooLarge).
  [[nodiscard]] Result<std::int64_t> count();
  /// All voxels, sorted and unique. Refused: over `most` (kTooLarge), before memory is taken for them.
  [[nodiscard]] Result<std::vector<VoxelIndex>> take();

 private:
  struct Run {
    std::int32_t x, y, first, last;
    auto operator<=>(const Run&) const = default;
  };
  std::int64_t join();

  std::int64_t most_;
  std::int64_t part_ = 0;  ///< voxels of this part
  std::vector<Run> runs_;
};

[[nodiscard]] tl::unexpected<Error> refuse_too_many(std::int64_t most);

}  // namespace concord
