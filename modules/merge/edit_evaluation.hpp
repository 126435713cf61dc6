#pragma once

#include "core/brick_map.hpp"
#include "core/corrections.hpp"
#include "core/error.hpp"

namespace concord {

/// What an edit pins, found out once, when it is made: kAdd pins all selected voxels occupied, kDelete all free. kMove
/// pins those of them that are occupied in the map free, and occupied as many voxels further as `move`, turned into
/// the map and rounded, says; a voxel that is left and reached is pinned occupied only.
///
/// `T_map_frame` places the request's frame in the map. Refused: what `select` refuses; for a move none of them
/// occupied (kEmpty), less than half a voxel (kBadRequest), a voxel that is occupied and not itself moved away
/// (kCollision), beyond the map (kOutOfBounds); over kMaxEditVoxels pins (kTooLarge).
[[nodiscard]] Result<Correction::Edit> evaluate(const EditRequest& request, const Transform& T_map_frame,
                                                const BrickMap& map, double resolution);

}  // namespace concord
