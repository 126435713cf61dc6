#include "agent/sim/score.hpp"

#include <gtest/gtest.h>

namespace concord {
namespace {

class Score : public testing::Test {
 protected:
  static constexpr double kResolution = 0.1;

  static void SetUpTestSuite() { truth_ = new Truth(make_truth(make_warehouse(1), kResolution)); }
  static void TearDownTestSuite() { delete truth_; }

  static const Truth* truth_;
};
const Truth* Score::truth_ = nullptr;

TEST_F(Score, OfAPerfectMap) {
  const MapScore result = score(truth_->surface.to_map(), *truth_);
  EXPECT_EQ(result.precision, 1);
  EXPECT_EQ(result.recall, 1);
  ASSERT_EQ(result.features.size(), 5U);
  for (const FeatureScore& feature : result.features) {
    EXPECT_EQ(feature.share, 1) << feature.name;
    EXPECT_TRUE(feature.found);
  }
}

TEST_F(Score, OfAnEmptyMap) {
  const MapScore result = score(BrickMap(), *truth_);
  EXPECT_EQ(result.precision, 0);
  EXPECT_EQ(result.recall, 0);
  for (const FeatureScore& feature : result.features) EXPECT_FALSE(feature.found) << feature.name;
}

TEST_F(Score, OfAMapOffByOneAndByMore) {
  const auto moved = [&](std::int32_t by) {
    VoxelSet set;
    truth_->surface.for_each([&](VoxelIndex v) { set.insert({v.x + by, v.y, v.z}); });
    return score(set.to_map(), *truth_);
  };
  EXPECT_EQ(moved(1).precision, 1);
  EXPECT_EQ(moved(1).recall, 1);
  EXPECT_LT(moved(1000).precision, 1e-9);
  EXPECT_LT(moved(1000).recall, 1e-9);
}

TEST_F(Score, FreeVoxelsDoNotCount) {
  BrickMap map;
  VoxelMask all;
  all.fill(~std::uint64_t{0});
  map.set({2, 2, 0}, Brick::uniform(all, kFree));
  EXPECT_EQ(score(map, *truth_).recall, 0);
}

TEST_F(Score, WhatCanBeSeenIsMostOfWhatFacesTheHall) {
  const std::size_t seen = truth_->observable.size(), all = truth_->surface.size();
  EXPECT_GT(seen, all / 10);
  EXPECT_LT(seen, all);
  truth_->observable.for_each([&](VoxelIndex v) { EXPECT_TRUE(truth_->surface.contains(v)); });
}

}  // namespace
}  // namespace concord
