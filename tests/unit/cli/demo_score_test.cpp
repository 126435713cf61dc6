#include "cli/demo_score.hpp"

#include <gtest/gtest.h>

namespace concord {
namespace {

TEST(DemoScore, OccupiedVoxelsAloneAreKept) {
  BrickMap map;
  DenseBrick values;
  values.fill(kFree);
  values[7] = kOccupied;
  map.set({0, 0, 0}, Brick::from_dense(values));
  values[7] = kFree;
  map.set({1, 0, 0}, Brick::from_dense(values));
  const BrickMap part = occupied_part(map);
  EXPECT_EQ(part.brick_count(), 1U);
  EXPECT_EQ(part.known_count(), 1U);
  EXPECT_EQ(part.occupied_count(), 1U);
}

TEST(DemoScore, TellsWhenASurfaceWasShownOrThatItNeverWas) {
  const World world = make_warehouse(1);
  constexpr double kResolution = 0.2;
  BrickMap all;
  VoxelMask full;
  full.fill(~std::uint64_t{0});
  for (std::int32_t x = -2; x < 30; ++x) {
    for (std::int32_t y = -2; y < 30; ++y) {
      for (std::int32_t z = -1; z < 5; ++z) all.set({x, y, z}, Brick::uniform(full, kOccupied));
    }
  }
  const DemoScorer scorer(world, kResolution, Transform::Identity());
  ASSERT_GT(scorer.merged(all).recall, 0.9);
  const std::vector<MappingMoment> moments = {{0, 0, {}, {}}, {10, 10, {}, {}}, {20, 20, all, {}}, {30, 25, all, all}};
  EXPECT_EQ(scorer.merged_reached(moments, 0.9), 20.0);
  EXPECT_EQ(scorer.robot_reached(moments, 0.9), 25.0);
  EXPECT_EQ(scorer.robot_reached({moments.begin(), moments.end() - 1}, 0.9), std::nullopt);
}

}  // namespace
}  // namespace concord
