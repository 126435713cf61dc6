#include "scene.hpp"

#include <algorithm>

namespace concord::testing {
namespace {

int pick(std::mt19937& random, int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); }

LogOdds random_value(std::mt19937& random) {
  switch (pick(random, 0, 5)) {
    case 0: return kFree;
    case 1: return kOccupied;
    case 2: return static_cast<LogOdds>(pick(random, -3, 3));
    case 3: return static_cast<LogOdds>(pick(random, 0, 1) == 0 ? kConflictFree : kConflictOccupied);
    case 4: return static_cast<LogOdds>(pick(random, 0, 1) == 0 ? kPinnedFree : kPinnedOccupied);
    default: return static_cast<LogOdds>(pick(random, -4000, 4000));
  }
}

void add_box(VoxelValues& voxels, std::mt19937& random, VoxelIndex around) {
  const VoxelIndex low{around.x + pick(random, -20, 20), around.y + pick(random, -20, 20),
                       around.z + pick(random, -20, 20)};
  const VoxelIndex size{pick(random, 1, 12), pick(random, 1, 12), pick(random, 1, 3)};
  const bool is_uniform = pick(random, 0, 1) == 0;
  const LogOdds value = random_value(random);
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        voxels[{low.x + x, low.y + y, low.z + z}] = is_uniform ? value : random_value(random);
      }
    }
  }
}

void add_noise(VoxelValues& voxels, std::mt19937& random, VoxelIndex around, int count) {
  for (int i = 0; i < count; ++i) {
    const VoxelIndex voxel{around.x + pick(random, -24, 24), around.y + pick(random, -24, 24),
                           around.z + pick(random, -24, 24)};
    voxels[voxel] = random_value(random);
  }
}

Transform random_transform(std::mt19937& random, double resolution) {
  std::normal_distribution<double> normal;
  Transform T = Transform::Identity();
  switch (pick(random, 0, 5)) {
    case 0: T.translation() = Eigen::Vector3d(pick(random, -3, 3), pick(random, -3, 3), pick(random, -3, 3)) * 8; break;
    case 1: T.translation() = Eigen::Vector3d(pick(random, -9, 9), pick(random, -9, 9), pick(random, -9, 9)); break;
    case 2:
      T.linear() = Eigen::AngleAxisd(M_PI_2 * pick(random, 1, 3), Eigen::Vector3d::UnitZ()).toRotationMatrix();
      T.translation() = Eigen::Vector3d(pick(random, -9, 9), pick(random, -9, 9), pick(random, -9, 9));
      break;
    default:
      T.linear() = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                       .normalized()
                       .toRotationMatrix();
      T.translation() = Eigen::Vector3d(normal(random), normal(random), normal(random)) * 6;
  }
  T.translation() *= resolution;
  return T;
}

void set_pin(Scene& scene, VoxelIndex voxel, bool occupied) {
  scene.pinned[voxel] = occupied;
  scene.pins.set(voxel, occupied ? PinMap::Pin::kAdded : PinMap::Pin::kDeleted);
}

void touch_all(const SceneLayer& layer, double resolution, BrickSet& dirty) {
  const LatticeTransform transform(layer.T_map_layer, resolution);
  for (const BrickIndex index : layer.map.sorted_bricks()) transform.touch(index, dirty);
}

VoxelIndex any_voxel(const SceneLayer& layer, std::mt19937& random) {
  return std::next(layer.voxels.begin(), pick(random, 0, static_cast<int>(layer.voxels.size()) - 1))->first;
}

void change_voxels(SceneLayer& layer, double resolution, std::mt19937& random, BrickSet& dirty) {
  VoxelValues changed;
  const VoxelIndex around = any_voxel(layer, random);
  add_noise(changed, random, around, 5);
  const LatticeTransform transform(layer.T_map_layer, resolution);
  for (const auto& [voxel, value] : changed) {
    layer.voxels[voxel] = value;
    transform.touch(brick_of(voxel), dirty);
  }
  const VoxelIndex gone = any_voxel(layer, random);
  layer.voxels.erase(gone);
  transform.touch(brick_of(gone), dirty);
  layer.map = to_bricks(layer.voxels);
}

}  // namespace

std::vector<Layer> Scene::as_layers() const {
  std::vector<Layer> out;
  for (const SceneLayer& layer : layers) out.push_back({&layer.map, layer.T_map_layer, layer.weight});
  return out;
}

BrickMap to_bricks(const VoxelValues& voxels) {
  std::map<BrickIndex, DenseBrick> dense;
  for (const auto& [voxel, value] : voxels) {
    const auto [it, is_new] = dense.try_emplace(brick_of(voxel));
    if (is_new) it->second.fill(kUnknown);
    it->second[local_of(voxel)] = value;
  }
  BrickMap map;
  for (const auto& [index, brick] : dense) map.set(index, Brick::from_dense(brick));
  return map;
}

Scene random_scene(std::uint32_t seed) {
  std::mt19937 random(seed);
  Scene scene;
  scene.resolution = std::array{0.02, 0.05, 0.1, 0.25}[pick(random, 0, 3)];
  // Mostly around the origin, where signs change; at times far away, where precision is scarce.
  const int far = pick(random, 0, 4) == 0 ? 30000 : 0;
  const VoxelIndex around{far + pick(random, -8, 8), pick(random, -8, 8) - far, pick(random, -8, 8)};
  const int layers = pick(random, 1, 4);
  for (int i = 0; i < layers; ++i) {
    SceneLayer layer;
    const int boxes = pick(random, 1, 5);
    for (int box = 0; box < boxes; ++box) add_box(layer.voxels, random, around);
    add_noise(layer.voxels, random, around, pick(random, 0, 60));
    layer.map = to_bricks(layer.voxels);
    layer.weight = std::array{1, 2, 3, 7, 500, 1000}[pick(random, 0, 5)];
    layer.T_map_layer = random_transform(random, scene.resolution);
    // Turned about its own place, so that the layers overlap.
    const Eigen::Vector3d centre = centre_of(around, scene.resolution);
    if (far != 0) layer.T_map_layer.translation() += centre - layer.T_map_layer.linear() * centre;
    scene.layers.push_back(std::move(layer));
  }
  const int pins = pick(random, 0, 30);
  for (int i = 0; i < pins; ++i) {
    const VoxelIndex voxel{around.x + pick(random, -30, 30), around.y + pick(random, -10, 10),
                           around.z + pick(random, -10, 10)};
    set_pin(scene, voxel, pick(random, 0, 1) == 0);
  }
  return scene;
}

void change(Scene& scene, std::mt19937& random, BrickSet& dirty) {
  SceneLayer& layer = scene.layers[pick(random, 0, static_cast<int>(scene.layers.size()) - 1)];
  switch (pick(random, 0, 4)) {
    case 0:
      touch_all(layer, scene.resolution, dirty);
      layer.T_map_layer.translation() += Eigen::Vector3d(0.3, -0.7, 1.1) * scene.resolution;
      layer.T_map_layer.rotate(Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY()));
      touch_all(layer, scene.resolution, dirty);
      break;
    case 1:
      layer.weight = pick(random, 1, 1000);
      touch_all(layer, scene.resolution, dirty);
      break;
    case 2: {
      const VoxelIndex voxel = any_voxel(layer, random);
      set_pin(scene, voxel, pick(random, 0, 1) == 0);
      dirty.insert(brick_of(voxel));
      break;
    }
    default: change_voxels(layer, scene.resolution, random, dirty);
  }
}

}  // namespace concord::testing
