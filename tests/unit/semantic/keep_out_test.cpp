#include "semantic/labels/keep_out.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace concord {
namespace {

constexpr double kResolution = 0.1;

Outline around(const std::vector<VoxelIndex>& voxels) { return outline_of(voxels, kResolution); }

Eigen::Vector3d middle_of(const KeptClearOf& thing) {
  const Outline& outline = thing.outline;
  const VoxelIndex voxel{static_cast<std::int32_t>(outline.sum_x / outline.count),
                         static_cast<std::int32_t>(outline.sum_y / outline.count), outline.lowest};
  return centre_of(voxel, kResolution);
}

RC_GTEST_PROP(KeepOut, HoldsAllGroundWithinTheMarginAndLittleMore, ()) {
  std::vector<VoxelIndex> voxels;
  const auto side = *rc::gen::inRange(1, 9);
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < 3; ++y) voxels.push_back({x - 4, y + 7, 5});
  }
  const KeptClearOf thing{"forklift 1", around(voxels), 0.05 * *rc::gen::inRange(1, 30)};
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
    things.push_back({"box " + std::to_string(i), around({{i * 30, i % 7 * 25, 0}, {i * 30, i % 7 * 25, 1}}), 0.3});
  }
  EXPECT_EQ(keep_out_zones(things, kResolution).size(), 40U);
  const auto few = keep_out_zones(things, kResolution, 10);
  EXPECT_LE(few.size(), 10U);
  EXPECT_GE(few.size(), 3U);
  for (const KeptClearOf& thing : things) {
    const Eigen::Vector3d p = middle_of(thing);
    EXPECT_TRUE(std::ranges::any_of(few, [&](const Zone& zone) { return contains(zone.volume, zone.T_map_zone, p); }));
  }
  EXPECT_TRUE(few.front().name.ends_with("others"));
}

TEST(KeepOut, ZonesThatAreSharedAreOfOneCost) {
  std::vector<KeptClearOf> things;
  for (int i = 0; i < 60; ++i) {
    things.push_back({"box " + std::to_string(i), around({{i * 30, i % 7 * 25, 0}}), 0.3, i % 3});
  }
  const auto few = keep_out_zones(things, kResolution, Zone::kMaxCost + 1);
  EXPECT_LE(few.size(), Zone::kMaxCost + 1U);
  for (const KeptClearOf& thing : things) {
    const Eigen::Vector3d p = middle_of(thing);
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
    things.push_back({"chair " + std::to_string(i), around({voxel}), 0.1});
    things.push_back({"near chair " + std::to_string(i), around({voxel}), 0.3, 4});
  }
  const auto zones = keep_out_zones(things, kResolution, 50);
  EXPECT_LE(zones.size(), 50U);
  EXPECT_EQ(std::ranges::count(zones, Zone::Kind::kNoGo, &Zone::kind), 30);
}

TEST(KeepOut, LongNamesAreCutBetweenCharacters) {
  std::string name;
  for (int i = 0; i < 30; ++i) name += "€";
  const KeptClearOf thing{name + " 7", around({{0, 0, 0}}), 0.1};
  const auto zones = keep_out_zones({&thing, 1}, kResolution);
  EXPECT_EQ(zones[0].name.size(), 78U);
}

/// Kept brick by brick, whatever came and went, they are as they would be made anew.
RC_GTEST_PROP(Outlines, AreOfWhatLiesInTheirBricksNow, ()) {
  Outlines kept;
  std::map<BrickIndex, std::map<InstanceId, std::vector<VoxelIndex>>> there;
  const auto turns = *rc::gen::inRange(1, 30);
  for (int turn = 0; turn < turns; ++turn) {
    const BrickIndex index{*rc::gen::inRange(-2, 2), *rc::gen::inRange(-2, 2), 0};
    auto& in_brick = there[index];
    in_brick.clear();
    for (const int local : *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, kBrickVoxels))) {
      in_brick[{1, static_cast<std::uint32_t>(*rc::gen::inRange(1, 4))}].push_back(voxel_at(index, local));
    }
    Outlines::InBrick now;
    for (const auto& [of, voxels] : in_brick) now.emplace(of, around(voxels));
    kept.set(index, now);
    if (*rc::gen::arbitrary<bool>()) continue;  // several changes may come before anybody asks
    std::map<InstanceId, std::vector<VoxelIndex>> all;
    for (const auto& [at, by_instance] : there) {
      for (const auto& [of, voxels] : by_instance) all[of].insert(all[of].end(), voxels.begin(), voxels.end());
    }
    std::map<InstanceId, Outline> anew;
    for (const auto& [of, voxels] : all) anew.emplace(of, around(voxels));
    RC_ASSERT(kept.all() == anew);
    RC_ASSERT(!kept.is_stale());
  }
  kept.clear();
  RC_ASSERT(kept.all().empty());
}

}  // namespace
}  // namespace concord
