#include <gtest/gtest.h>

#include "align/cloud.hpp"
#include "align/column_search.hpp"
#include "align/prepare.hpp"
#include "align/wall_grid.hpp"
#include "rooms.hpp"

// Maps that are too dense, too large or too wide: made coarser, cut back or refused, in bounded time and memory.

namespace concord::test {
namespace {

/// Points `step` apart on a wall along x.
Points wall(double length, double height, double step, const Eigen::Vector3d& at = Eigen::Vector3d::Zero()) {
  Points out;
  for (double x = 0.0; x < length; x += step) {
    for (double z = 0.0; z < height; z += step) out.push_back((at + Eigen::Vector3d(x, 0.0, z)).cast<float>());
  }
  return out;
}

void add(Points& points, const Points& more) { points.insert(points.end(), more.begin(), more.end()); }

Points far_panel() { return wall(1.0, 2.0, kSpacing, {1500.0, 1300.0, 0.0}); }

/// Points that touch nothing, each in blocks of its own.
Points scattered(std::size_t count) {
  Points out;
  std::uint64_t state = 1;
  const auto next = [&] {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<float>(static_cast<double>(state >> 40) * 2000.0 / (1 << 24) - 1000.0);
  };
  for (std::size_t i = 0; i < count; ++i) {
    const float x = next(), y = next(), z = next();
    out.emplace_back(x, y, z);
  }
  return out;
}

TEST(PrepareCloud, FindsOutHowDenseItIs) {
  EXPECT_EQ(prepare_cloud(wall(4, 2, 0.03)).resolution, 0.05);
  EXPECT_EQ(prepare_cloud(wall(8, 4, 0.08)).resolution, 0.1);
  EXPECT_EQ(prepare_cloud(wall(16, 8, 0.18)).resolution, 0.2);
  EXPECT_EQ(prepare_cloud(wall(80, 80, 2.0)).resolution, 0.4);
}

TEST(PrepareCloud, ThinsWhatHasManyPoints) {
  const Points few = wall(4, 2, 0.01);
  EXPECT_EQ(prepare_cloud(few).points.size(), few.size());
  const PreparedCloud thin = prepare_cloud(wall(12, 9, 0.01));
  EXPECT_EQ(thin.resolution, 0.05);
  EXPECT_NEAR(static_cast<double>(thin.points.size()), 12 * 9 / (0.025 * 0.025), 0.02 * 12 * 9 / (0.025 * 0.025));
  for (const Eigen::Vector3f& p : thin.points) EXPECT_TRUE(p.x() >= 0 && p.x() <= 12 && p.y() == 0 && p.z() <= 9);
}

/// A building scanned at 4 cm: over 4 million points however they are thinned at its own resolution.
TEST(PrepareMap, ADenseCloudOfABuildingIsMadeCoarser) {
  Points building;
  for (int side = 0; side < 11; ++side) add(building, wall(200, 3, 0.04, {0, 5.0 * side, 0}));
  ASSERT_GT(building.size(), kMaxSurfacePoints);
  const auto map = prepare_map(building, 2);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->resolution, 0.1);
}

TEST(PrepareMap, AMapThatIsTooFineIsMadeCoarser) {
  BrickMap fine;
  DenseBrick full;
  full.fill(kOccupied);
  for (int x = 0; x < 40; ++x) fine.set({x, 0, 0}, Brick::from_dense(full));
  const auto map = prepare_map(fine, 0.01, 1);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->resolution, 0.05);
  EXPECT_EQ(prepare_map(fine, 5.0, 1).error().code, Code::kBadResolution);
}

TEST(PrepareMap, WhatIsScatteredOverAllTooMuchSpaceIsRefused) {
  const Points points = scattered(2 * kMaxSurfaceBlocks);
  EXPECT_EQ(make_align_map(points, 0.05, 1).error().code, Code::kTooLarge);
  EXPECT_EQ(prepare_map(points, 1).error().code, Code::kTooLarge);
  EXPECT_FALSE(are_scattered(wall(200, 90, 0.1), 0.05));
}

TEST(ColumnSearch, GivesPlacesInOrderAndApart) {
  const AlignMap map = cloud_map(room());
  const Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  const std::vector<PlanarPose> places = search_columns(map, R, map, R, {}, 1);
  ASSERT_GT(places.size(), 10U);
  EXPECT_LT(places.front().t.norm(), 0.2);
  EXPECT_LT(std::abs(places.front().yaw), degrees(3));
  EXPECT_GT(places.front().score, 0.5);
  // What is apart is where the source's walls have their middle, in cells of 0.1 m.
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  const auto columns = wall_columns(map, R, 0.1);
  for (const WallColumn& column : columns) middle += column.p.cast<double>() / static_cast<double>(columns.size());
  const auto at = [&](const PlanarPose& pose) {
    return Eigen::Vector2d(Eigen::Rotation2Dd(pose.yaw) * middle + pose.t);
  };
  for (std::size_t i = 1; i < places.size(); ++i) {
    EXPECT_LE(places[i].score, places[i - 1].score);
    for (std::size_t j = 0; j < i; ++j) {
      const double turn = std::abs(std::remainder(places[i].yaw - places[j].yaw, 2.0 * std::numbers::pi));
      EXPECT_TRUE((at(places[i]) - at(places[j])).norm() > 0.5 - 1e-6 || turn > degrees(10) - 1e-6) << i << ' ' << j;
    }
  }
}

TEST(ColumnSearch, WhatIsSeenFarOffMakesNoRoomATown) {
  Points far = room();
  add(far, far_panel());
  const AlignMap source = cloud_map(far);
  const AlignMap target = cloud_map(room());
  const Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  for (const auto& [to, from] :
       {std::pair(&target, &source), std::pair(&source, &target), std::pair(&source, &source)}) {
    const std::vector<PlanarPose> places = search_columns(*to, R, *from, R, {}, 2);
    ASSERT_FALSE(places.empty());
    EXPECT_LT(places.front().t.norm(), 0.2);
    EXPECT_LT(std::abs(places.front().yaw), degrees(3));
  }
}

TEST(ColumnSearch, NothingIsLookedForInWhatIsTooWide) {
  Points town;
  for (int i = 0; i < 30; ++i) add(town, wall(2.0, 2.0, 0.1, {70.0 * i, 60.0 * (i * 7 % 30), 0.0}));
  const auto map = make_align_map(town, 0.1, 2);
  ASSERT_TRUE(map);
  const Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  EXPECT_TRUE(search_columns(*map, R, *map, R, {}, 2).empty());
  EXPECT_TRUE(search_columns(cloud_map(room()), R, *map, R, {}, 2).empty());
}

TEST(WithoutFar, KeepsABuildingWhole) {
  std::vector<WallColumn> building;
  for (int i = 0; i < 100; ++i) building.push_back({{static_cast<float>(i), static_cast<float>(i % 7)}, 1.0F});
  EXPECT_EQ(without_far(building).size(), building.size());
  building.push_back({{50.0F, 30.0F}, 1.0F});
  building.push_back({{-500.0F, 3.0F}, 1.0F});
  EXPECT_EQ(without_far(building).size(), building.size() - 2);
  EXPECT_TRUE(without_far({}).empty());
}

}  // namespace
}  // namespace concord::test
