#include "core/compose.hpp"

#include <algorithm>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "oracle.hpp"
#include "scene.hpp"

namespace concord {
namespace {

using testing::change;
using testing::compose_by_rules;
using testing::Expected;
using testing::random_scene;
using testing::Scene;
using testing::SceneLayer;

MergedMap compose(const Scene& scene, Policy policy, int threads = 1) {
  return concord::compose(scene.as_layers(), scene.pins, policy, scene.resolution, threads);
}

void expect_by_rules(const Scene& scene, Policy policy) {
  const MergedMap merged = compose(scene, policy);
  const std::map<VoxelIndex, Expected> expected = compose_by_rules(scene, policy);
  for (const auto& [voxel, want] : expected) {
    if (want.may_differ) continue;
    RC_ASSERT(merged.values.at(voxel) == want.value);
    RC_ASSERT(is_known(merged.conflicts.at(voxel)) == want.conflict);
  }
  merged.values.for_each_brick([&](BrickIndex index, const Brick& brick) {
    brick.for_each([&](int local, LogOdds) { RC_ASSERT(expected.contains(voxel_at(index, local))); });
  });
}

Policy any_policy() { return *rc::gen::element(Policy::kMean, Policy::kTable); }

TEST(Compose, EqualsTheRulesVoxelByVoxel) {
  EXPECT_TRUE(rc::check([](std::uint32_t seed) { expect_by_rules(random_scene(seed), any_policy()); }));
}

TEST(Compose, NoOccupiedVoxelVanishes) {
  EXPECT_TRUE(rc::check([](std::uint32_t seed) {
    Scene scene = random_scene(seed);
    scene.layers.resize(1);
    scene.pins.clear();
    const SceneLayer& layer = scene.layers[0];
    const MergedMap merged = compose(scene, any_policy());
    const double r = scene.resolution;
    for (const auto& [voxel, value] : layer.voxels) {
      if (!is_occupied(value)) continue;
      // On a boundary either neighbour will do, but one of them must have it.
      const Eigen::Vector3d p = layer.T_map_layer * centre_of(voxel, r);
      LogOdds found = kUnknown;
      for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d shift(corner & 1, corner >> 1 & 1, corner >> 2);
        found = std::max(found, merged.values.at(voxel_of(p + (shift.array() - 0.5).matrix() * 2e-4 * r, r)));
      }
      RC_ASSERT(found >= value);
    }
  }));
}

TEST(Compose, DoesNotDependOnTheOrderOfLayers) {
  EXPECT_TRUE(rc::check([](std::uint32_t seed) {
    Scene scene = random_scene(seed);
    const Policy policy = any_policy();
    const MergedMap before = compose(scene, policy);
    std::mt19937 random(seed);
    std::shuffle(scene.layers.begin(), scene.layers.end(), random);
    RC_ASSERT(compose(scene, policy) == before);
  }));
}

TEST(Compose, DoesNotDependOnTheNumberOfThreads) {
  EXPECT_TRUE(rc::check([](std::uint32_t seed) {
    const Scene scene = random_scene(seed);
    const Policy policy = any_policy();
    const MergedMap one = compose(scene, policy, 1);
    RC_ASSERT(compose(scene, policy, 2) == one);
    RC_ASSERT(compose(scene, policy, 5) == one);
  }));
}

TEST(Compose, FoldingWhatChangedEqualsFoldingEverything) {
  EXPECT_TRUE(rc::check([](std::uint32_t seed) {
    Scene scene = random_scene(seed);
    const Policy policy = any_policy();
    MergedMap map = compose(scene, policy);
    std::mt19937 random(seed);
    for (int step = 0; step < 6; ++step) {
      BrickSet dirty;
      change(scene, random, dirty);
      for (FoldedBrick& folded : fold(scene.as_layers(), scene.pins, policy, scene.resolution, dirty, 1 + step % 3)) {
        apply(std::move(folded), map);
      }
      RC_ASSERT(map == compose(scene, policy));
    }
  }));
}

TEST(Compose, FoldsEveryDirtyBrickInOrderAndNoOther) {
  EXPECT_TRUE(rc::check([](std::uint32_t seed) {
    const Scene scene = random_scene(seed);
    BrickSet dirty;
    dirty.insert_box({-2, -5, 0}, {3, 1, 2});
    const auto folded = fold(scene.as_layers(), scene.pins, any_policy(), scene.resolution, dirty);
    RC_ASSERT(folded.size() == dirty.size());
    for (std::size_t i = 0; i < folded.size(); ++i) {
      RC_ASSERT(dirty.contains(folded[i].index));
      if (i == 0) continue;
      const BrickIndex a = folded[i - 1].index;
      const BrickIndex b = folded[i].index;
      RC_ASSERT(std::pair(tile_of(a), local_of(a)) < std::pair(tile_of(b), local_of(b)));
    }
  }));
}

Scene two_voxels(LogOdds a, int weight_a, LogOdds b, int weight_b) {
  Scene scene;
  for (const auto& [value, weight] : {std::pair(a, weight_a), std::pair(b, weight_b)}) {
    SceneLayer layer;
    layer.voxels[{1, 2, 3}] = value;
    layer.map = testing::to_bricks(layer.voxels);
    layer.weight = weight;
    scene.layers.push_back(std::move(layer));
  }
  return scene;
}

LogOdds mean_of_two(LogOdds a, int weight_a, LogOdds b, int weight_b) {
  return compose(two_voxels(a, weight_a, b, weight_b), Policy::kMean).values.at({1, 2, 3});
}

TEST(Compose, RoundsMeansHalfAwayFromZero) {
  EXPECT_EQ(mean_of_two(1, 1, 2, 1), 2);
  EXPECT_EQ(mean_of_two(-1, 1, -2, 1), -2);
  EXPECT_EQ(mean_of_two(1, 2, 2, 1), 1);
  EXPECT_EQ(mean_of_two(-2048, 1, 3584, 1), 768);
  EXPECT_EQ(mean_of_two(kPinnedOccupied, 1000, kPinnedOccupied, 1000), kPinnedOccupied);
  EXPECT_EQ(mean_of_two(kPinnedFree, 1000, kPinnedFree, 1000), kPinnedFree);
}

TEST(Compose, ASumBelowZeroIsNeverOccupied) {
  EXPECT_EQ(mean_of_two(-1, 1, 0, 1000), -1);
  EXPECT_EQ(mean_of_two(-1, 999, 1, 998), -1);
  EXPECT_EQ(mean_of_two(-1, 1, 1, 1), 0);
}

TEST(Compose, TellsConflictsAndTakesPinsForAnAnswer) {
  Scene scene = two_voxels(kConflictOccupied, 1, kConflictFree, 1);
  EXPECT_EQ(compose(scene, Policy::kTable).conflicts.at({1, 2, 3}), kOccupied);
  scene.pins.set({1, 2, 3}, PinMap::Pin::kDeleted);
  EXPECT_EQ(compose(scene, Policy::kTable).conflicts.at({1, 2, 3}), kUnknown);
  EXPECT_EQ(compose(scene, Policy::kTable).values.at({1, 2, 3}), kPinnedFree);
  EXPECT_TRUE(compose(two_voxels(409, 1, kConflictFree, 1), Policy::kMean).conflicts.empty());
  EXPECT_TRUE(compose(two_voxels(kConflictOccupied, 1, -409, 1), Policy::kMean).conflicts.empty());
}

TEST(Compose, LeavesOutWhatWouldLieOutOfBounds) {
  Scene scene = two_voxels(kOccupied, 1, kFree, 1);
  scene.layers[0].T_map_layer.translation().x() = kMaxVoxel * scene.resolution;
  scene.layers[0].T_map_layer.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));
  EXPECT_EQ(compose(scene, Policy::kMean).values.known_count(), 1U);
  BrickSet dirty;
  LatticeTransform(scene.layers[0].T_map_layer, scene.resolution).touch(BrickIndex{0, 0, 0}, dirty);
  for (const auto& [tile, bricks] : dirty.sorted()) EXPECT_TRUE(in_bounds(origin_of(tile)));
}

TEST(Compose, ALayerFitsUpToTheLastBrickAndNotBeyond) {
  BrickMap map;
  map.set({kMaxVoxel / kBrickSide - 2, 0, 0}, Brick::uniform({1}, kOccupied));
  Layer layer{&map, Transform::Identity(), 1};
  const double resolution = 0.05;
  const auto shifted = [&](double voxels) {
    layer.T_map_layer.translation().x() = voxels * resolution;
    return fits(layer, resolution);
  };
  EXPECT_TRUE(shifted(0));
  EXPECT_TRUE(shifted(kBrickSide));
  EXPECT_FALSE(shifted(2 * kBrickSide));
  EXPECT_TRUE(shifted(3.5));
  EXPECT_FALSE(shifted(kBrickSide + 1.5));
  EXPECT_TRUE(shifted(-kMaxVoxel)) << "its lower bound is below";
  EXPECT_FALSE(shifted(-3 * kMaxVoxel));
}

TEST(Compose, OfNothingIsEmpty) {
  EXPECT_TRUE(concord::compose({}, {}, Policy::kMean, 0.05).values.empty());
  EXPECT_TRUE(fold({}, {}, Policy::kMean, 0.05, {}).empty());
}

}  // namespace
}  // namespace concord
