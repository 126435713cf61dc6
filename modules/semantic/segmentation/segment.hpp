#pragma once

#include "core/error.hpp"
#include "semantic/brick_masks.hpp"

namespace concord {

/// What a person meant by one touch.
struct Proposal {
  enum class Kind { kFlatTopped, kUpright, kCluster };
  BrickMasks voxels;
  Kind kind = Kind::kCluster;
};

/// Proposes the object that was touched at `p_map`, from occupied voxels alone: a person looks at it, changes it,
/// labels it. The map must be z up.
///
/// What lies within kSegmentReach of the seed is looked at. Floor, ceiling and walls are taken away (find_room_planes).
/// Then, in this order:
/// - something with a level top (a table, a seat with its back, a cupboard): all below that top, down to the floor;
/// - an upright face (a screen): what hangs together in its plane, up to what it stands on;
/// - else what hangs together with the seed, without what it stands on, within 0.75 m.
/// Refused: nothing occupied within 0.5 m of the seed that is not floor, ceiling or wall (kEmpty).
/// @param occupied of the map, at least what is `reach_of_touch`; the more the slower
[[nodiscard]] Result<Proposal> propose_object(const BrickMasks& occupied, double resolution,
                                              const Eigen::Vector3d& p_map);

/// What a touch there may look at.
[[nodiscard]] VoxelBox reach_of_touch(const Eigen::Vector3d& p_map, double resolution);

inline constexpr double kSegmentReach = 4.0;   ///< metres, along each axis
inline constexpr double kFarthestTouch = 0.5;  ///< of an object from the seed
inline constexpr double kClusterReach = 0.75;

}  // namespace concord
