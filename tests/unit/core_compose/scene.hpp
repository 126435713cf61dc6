#pragma once

#include <cstdint>
#include <map>
#include <random>
#include <vector>

#include "core/compose.hpp"

namespace concord::testing {

using VoxelValues = std::map<VoxelIndex, LogOdds>;

/// A layer twice: for the oracle voxel by voxel, for the code under test in bricks.
struct SceneLayer {
  VoxelValues voxels;
  BrickMap map;
  Transform T_map_layer = Transform::Identity();
  int weight = 1;
};

struct Scene {
  double resolution = 0.05;
  std::vector<SceneLayer> layers;
  std::map<VoxelIndex, bool> pinned;  ///< true: occupied
  PinMap pins;

  [[nodiscard]] std::vector<Layer> as_layers() const;
};

[[nodiscard]] BrickMap to_bricks(const VoxelValues& voxels);

/// Walls, rooms and noise around a random place, under random transforms: any rotation, and now and then one that maps
/// the lattice onto itself.
[[nodiscard]] Scene random_scene(std::uint32_t seed);

/// Changes some voxels of one layer, or its transform or weight, or some pins; adds to `dirty` what that touches.
void change(Scene& scene, std::mt19937& random, BrickSet& dirty);

}  // namespace concord::testing
