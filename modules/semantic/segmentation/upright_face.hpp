#pragma once

#include <optional>

#include "semantic/brick_masks.hpp"

namespace concord {

/// The voxels of the upright face at `seed`, up to 1.5 voxels off its plane; none if there is no such face of 0.04
/// square metres. The plane is found around the seed (random sample consensus, PCL, fixed seed), grown through
/// neighbours, and found again in what was grown; then the face ends where its outline steps (rectangle_around).
/// @param candidates occupied voxels without the room and what the object stands on.
[[nodiscard]] std::optional<BrickMasks> find_upright_face(const BrickMasks& candidates, VoxelIndex seed,
                                                          double resolution);

}  // namespace concord
