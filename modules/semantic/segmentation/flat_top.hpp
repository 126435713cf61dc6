#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "semantic/brick_masks.hpp"

namespace concord {

/// One column of voxels.
using Cell = std::pair<std::int32_t, std::int32_t>;

/// A level surface on top of an object: a table, a seat, a cupboard.
struct FlatTop {
  std::int32_t z = 0;  ///< its voxel layer (the median)
  /// Its columns, and the layer of each: its own, or the median where something stands on it.
  std::map<Cell, std::int32_t> cells;
  std::vector<Cell> behind;  ///< sorted; of a seat: where its back and arms rise
  double width = 0.0;        ///< the lesser edge of the rectangle around it, metres
};

/// Searches the column of `seed` upwards, as far as there is something in it, for a level surface; then the columns
/// around it, up to kFlatSide away.
///
/// Columns belong to it that have a voxel with kFlatHeadroom above it, at most kFlatOff from that layer and one voxel
/// from their neighbour's. Furniture that stands side by side is told apart by its outline: what is seen from the
/// roomiest place near the seed along the two axes of a rectangle, up to where a strip across it becomes wider by 0.1 m
/// or more for good. The rectangle's direction is the one that its cells fill best.
/// @param free_of_room occupied voxels without floor, walls and ceiling. @param floor_z the floor's layer.
[[nodiscard]] std::optional<FlatTop> find_flat_top(const BrickMasks& free_of_room, std::int32_t floor_z,
                                                   VoxelIndex seed, double resolution);

/// Of furniture that stands against a wall, adds the columns between its top and the wall, up to kGapToWall: where a
/// scan rounds the corner off, they are level with neither.
/// @param room see RoomPlanes::voxels
void reach_walls(FlatTop& top, const BrickMasks& room, double resolution);

inline constexpr double kFlatOff = 0.1;  ///< metres, as all of these
inline constexpr double kFlatSide = 0.15;
inline constexpr double kFlatHeadroom = 0.2;
inline constexpr double kGapToWall = 0.2;
inline constexpr double kLeastFlatWidth = 0.3;             ///< of a top; less is an edge or a shelf's front
inline constexpr double kMostFlatExtent = 4.0;             ///< from the seed
inline constexpr double kSeatLow = 0.25, kSeatHigh = 0.6;  ///< above the floor
/// Of a back or arm: how far it rises above its seat, and how deep it is at most; what is deeper is another thing.
inline constexpr double kRestHeight = 0.7;
inline constexpr double kRestDepth = 0.45;

}  // namespace concord
