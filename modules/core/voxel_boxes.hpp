#pragma once

#include <span>
#include <vector>

#include "core/error.hpp"
#include "core/lattice.hpp"

namespace concord {

/// Voxels from `min` to `max`, both included.
struct VoxelBox {
  VoxelIndex min, max;
  auto operator<=>(const VoxelBox&) const = default;
};

/// Few boxes that hold exactly these voxels: how a selection travels. @pre sorted and unique.
[[nodiscard]] std::vector<VoxelBox> to_boxes(std::span<const VoxelIndex> voxels);

/// The voxels of all boxes, sorted and unique. Refused before memory is taken: a box turned inside out
/// (kBadRequest), indices out of bounds (kOutOfBounds), over `most` voxels counted per box (kTooLarge), none (kEmpty).
[[nodiscard]] Result<std::vector<VoxelIndex>> expand(std::span<const VoxelBox> boxes, std::int64_t most);

}  // namespace concord
