#pragma once

#include <span>
#include <stop_token>
#include <vector>

#include "core/brick_map.hpp"
#include "core/brick_set.hpp"
#include "core/lattice_transform.hpp"
#include "core/pins.hpp"
#include "core/policy.hpp"

namespace concord {

/// One source's claim about space, and where it lies in the map. It has the map's resolution.
struct Layer {
  const BrickMap* map = nullptr;
  Transform T_map_layer = Transform::Identity();
  int weight = 1;  ///< 1 to 1000
};

/// Whether all of the layer would lie within the map's bounds: what lies beyond them is in no fold.
[[nodiscard]] bool fits(const Layer& layer, double resolution);

/// One brick of the merged map.
struct FoldedBrick {
  BrickIndex index;
  Brick values;           ///< empty where nothing is known
  VoxelMask conflicts{};  ///< where one layer says occupied and another free, and no person has decided
};

/// The map as planners and headsets read it.
struct MergedMap {
  BrickMap values;
  BrickMap conflicts;  ///< kOccupied in conflicting voxels

  bool operator==(const MergedMap&) const = default;
};

/// Folds the bricks in `dirty` afresh from all layers, pins last. One entry for each of them that is in bounds, ordered
/// by tile and by position in the tile. The result depends neither on the order of the layers nor on `threads`.
[[nodiscard]] std::vector<FoldedBrick> fold(std::span<const Layer> layers, const PinMap& pins, Policy policy,
                                            double resolution, const BrickSet& dirty, int threads = 1);

/// Puts a folded brick into the map. Returns whether the map changed.
bool apply(FoldedBrick folded, MergedMap& map);

/// The merged map of these layers and pins: what folding all bricks that any of them touches leads to. Once a stop is
/// asked for it ends before the next tile, and what it returns is of no use.
[[nodiscard]] MergedMap compose(std::span<const Layer> layers, const PinMap& pins, Policy policy, double resolution,
                                int threads = 1, const std::stop_token& stop = {});

}  // namespace concord
