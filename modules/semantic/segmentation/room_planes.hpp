#pragma once

#include <optional>

#include "semantic/brick_masks.hpp"

namespace concord {

/// What a room is made of: nobody means it when they touch an object.
struct RoomPlanes {
  BrickMasks voxels;                    ///< of floor, ceiling and walls
  std::optional<std::int32_t> floor_z;  ///< voxel layer of the floor
  std::optional<std::int32_t> ceiling_z;
};

/// Finds floor, ceiling and walls among occupied voxels of a map that is z up.
///
/// Floor: the lowest three layers that together cover kFloorArea, if hardly anything lies below them. Ceiling: the same
/// from above; either with the layers next to it, up to four, that have half as many voxels. Walls: columns that are
/// occupied in most layers of the band from kWallLow to kWallHigh of the room's height, to which furniture does not
/// reach; a wall may lean by a voxel, and is as thick as it is seen. A map without floor or ceiling (a robot's) has its
/// lowest and highest layer for them; without a ceiling furniture may be as high as the map, so walls are long.
[[nodiscard]] RoomPlanes find_room_planes(const BrickMasks& occupied, double resolution);

inline constexpr double kFloorArea = 1.0;  ///< square metres
inline constexpr double kWallLow = 0.65, kWallHigh = 0.95;
inline constexpr double kLeastHeight = 1.5;  ///< metres from a floor to its ceiling
inline constexpr double kLeastWall = 1.5;    ///< metres along x or y, where no ceiling is seen
inline constexpr double kWallFilled = 0.7;   ///< of the band's layers

}  // namespace concord
