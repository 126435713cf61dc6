#pragma once

#include <string>
#include <vector>

#include "agent/sim/ray_caster.hpp"
#include "agent/sim/world.hpp"
#include "core/brick_map.hpp"

namespace concord {

/// What a perfect map of a world would hold, on the map's lattice.
struct Truth {
  VoxelSet surface;
  /// Of the surface: what one of the agents would see on its way, were its ranges exact and everything opaque.
  VoxelSet observable;
  std::vector<std::pair<std::string, VoxelSet>> features;
};

[[nodiscard]] Truth make_truth(const World& world, double resolution);

struct FeatureScore {
  std::string name;
  double share = 0;    ///< of its surface voxels, those with an occupied one within one voxel
  bool found = false;  ///< at least half
};

/// "Within one voxel": the same or one of its 26 neighbours.
struct MapScore {
  double precision = 0;  ///< share of occupied voxels within one voxel of a surface; 0 for an empty map
  double recall = 0;     ///< share of observable surface voxels within one voxel of an occupied one
  std::vector<FeatureScore> features;
};

/// `map` is in the world's frame, at the truth's resolution.
[[nodiscard]] MapScore score(const BrickMap& map, const Truth& truth);

}  // namespace concord
