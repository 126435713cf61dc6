#include "semantic/labels/keep_out.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace concord {
namespace {

constexpr double kResolution = 0.1;

RC_GTEST_PROP(KeepOut, HoldsAllGroundWithinTheMarginAndLittleMore, ()) {
  KeptClearOf thing{"forklift 1", {}, 0.05 * *rc::gen::inRange(1, 30)};
  const auto side = *rc::gen::inRange(1, 9);
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < 3; ++y) thing.voxels.push_back({x - 4, y + 7, 5});
  }
  const auto zones = keep_out_zones({&thing, 1}, kResolution);
  RC_ASSERT(zones.size() == 1U);
  RC_ASSERT(check(zones[0].volume).has_value());
  const Eigen::Vector2d low(-0.4, 0.7), high(-0.4 + 0.1 * side, 1.0);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d p(*rc::gen::inRange(-400, 400) * 0.01, *rc::gen::inRange(-300, 500) * 0.01);
    const double away = (p - p.cwiseMax(low).cwiseMin(high)).norm();
    const bool in = contains(zones[0].volume, zones[0].T_map_zone, {p.x(), p.y(), 0.55});
    if (away <= thing.margin - 1e-6) RC_ASSERT(in);
    if (away >= thing.margin * 1.006 + 1e-6) RC_ASSERT(!in);
  }
  RC_ASSERT(!contains(zones[0].volume, zones[0].T_map_zone, {-0.3, 0.8, 0.7}));  // above it
}

TEST(KeepOut, ManyThingsShareZonesThatHoldAllOfThem) {
  std::vector<KeptClearOf> things;
  for (int i = 0; i < 40; ++i) {
    things.push_back({"box " + std::to_string(i), {{i * 30, i % 7 * 25, 0}, {i * 30, i % 7 * 25, 1}}, 0.3});
  }
  EXPECT_EQ(keep_out_zones(things, kResolution).size(), 40U);
  const auto few = keep_out_zones(things, kResolution, 10);
  EXPECT_LE(few.size(), 10U);
  EXPECT_GE(few.size(), 3U);
  for (const KeptClearOf& thing : things) {
    const Eigen::Vector3d p = centre_of(thing.voxels[0], kResolution);
    EXPECT_TRUE(std::ranges::any_of(few, [&](const Zone& zone) { return contains(zone.volume, zone.T_map_zone, p); }));
  }
  EXPECT_TRUE(few.front().name.ends_with("others"));
}

TEST(KeepOut, ZonesThatAreSharedAreOfOneCost) {
  std::vector<KeptClearOf> things;
  for (int i = 0; i < 60; ++i) {
    things.push_back({"box " + std::to_string(i), {{i * 30, i % 7 * 25, 0}}, 0.3, i % 3});
  }
  const auto few = keep_out_zones(things, kResolution, Zone::kMaxCost + 1);
  EXPECT_LE(few.size(), Zone::kMaxCost + 1U);
  for (const KeptClearOf& thing : things) {
    const Eigen::Vector3d p = centre_of(thing.voxels[0], kResolution);
    EXPECT_TRUE(std::ranges::any_of(few, [&](const Zone& zone) {
      return zone.cost == thing.cost && (zone.kind == Zone::Kind::kCostly) == (thing.cost > 0) &&
             contains(zone.volume, zone.T_map_zone, p);
    }));
  }
}

TEST(KeepOut, WhatOnlyCostsClosesNoWays) {
  std::vector<KeptClearOf> things;
  for (int i = 0; i < 30; ++i) {
    const VoxelIndex voxel{i * 12, 0, 0};
    things.push_back({"chair " + std::to_string(i), {voxel}, 0.1});
    things.push_back({"near chair " + std::to_string(i), {voxel}, 0.3, 4});
  }
  const auto zones = keep_out_zones(things, kResolution, 50);
  EXPECT_LE(zones.size(), 50U);
  EXPECT_EQ(std::ranges::count(zones, Zone::Kind::kNoGo, &Zone::kind), 30);
}

TEST(KeepOut, LongNamesAreCutBetweenCharacters) {
  std::string name;
  for (int i = 0; i < 30; ++i) name += "€";
  const KeptClearOf thing{name + " 7", {{0, 0, 0}}, 0.1};
  const auto zones = keep_out_zones({&thing, 1}, kResolution);
  EXPECT_EQ(zones[0].name.size(), 78U);
}

}  // namespace
}  // namespace concord
