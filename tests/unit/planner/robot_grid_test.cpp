#include "planner/robot_grid.hpp"

#include <gtest/gtest.h>

#include "planner/clearance.hpp"
#include "planner/plan.hpp"
#include "sketch.hpp"
#include "zones.hpp"

namespace concord {
namespace {

using Rows = std::vector<std::string>;

/// A map that changes, with its grid, zones and all that follows them.
class ChangingGround {
 public:
  ChangingGround() : zones_(1.0, band_) {}

  std::vector<BrickIndex> show(const Rows& rows, Cell origin) {
    const Grid wanted = test::sketch(rows, origin);
    std::vector<BrickIndex> touched;
    for (const BrickIndex index : map_.sorted_bricks()) {
      if (wanted.cells().find(index) != nullptr) continue;
      map_.set(index, Brick());
      touched.push_back(index);
    }
    wanted.cells().for_each_brick([&](BrickIndex index, const Brick& brick) {
      if (map_.set(index, brick)) touched.push_back(index);
    });
    return columns_of(grid_.update(map_, touched));
  }
  std::vector<BrickIndex> fence(const std::vector<Zone>& zones) { return columns_of(zones_.set(zones).columns); }
  [[nodiscard]] Terrain terrain() const { return {grid_, zones_}; }

 private:
  static std::vector<BrickIndex> columns_of(const std::vector<ColumnChange>& changes) {
    std::vector<BrickIndex> columns;
    for (const ColumnChange& change : changes) columns.push_back(change.column);
    return columns;
  }

  Band band_ = make_band(0, 1, 1.0).value();
  BrickMap map_;
  Grid grid_{1.0, band_, 0.5};
  ZoneLayer zones_;
};

void expect_fresh(RobotGrid& followed, const Terrain& terrain, double radius) {
  FreeSpace fresh(terrain, radius);
  const CellRectangle area = followed.area();
  for (std::int32_t y = area.low.y; y <= area.high.y; ++y) {
    for (std::int32_t x = area.low.x; x <= area.high.x; ++x) {
      ASSERT_EQ(followed.paths().grid().is_open(followed.local({x, y})), fresh.is_open({x, y})) << x << ' ' << y;
    }
  }
}

TEST(RobotGrid, FollowsEveryChangeAsIfItWereMadeAnew) {
  for (unsigned seed = 0; seed < 24; ++seed) {
    std::mt19937 random(seed);
    const Cell origin{static_cast<std::int32_t>(random() % 200) - 100, static_cast<std::int32_t>(random() % 200) - 100};
    const double radius = seed % 3 == 0 ? 0.0 : 0.01 * static_cast<double>(random() % 500);
    ChangingGround ground;
    Rows rows = test::strewn(random, 90, 70, 0.05, 0.02);
    ground.show(rows, origin);
    RobotGrids grids(ground.terrain(), 1);
    std::vector<Zone> zones;
    for (int change = 0; change < 12; ++change) {
      const auto area = grids.areas().around({origin.x + 40, origin.y + 40});
      ASSERT_TRUE(area);
      for (const Ignoring what : {Ignoring::kNothing, Ignoring::kNoGo, Ignoring::kUnobserved}) {
        expect_fresh(*grids.at(radius, what, *area), ground.terrain().without(what), radius);
        if (testing::Test::HasFatalFailure()) FAIL() << "seed " << seed << " change " << change;
      }
      if (change % 3 == 2) {
        zones.push_back(test::random_zone(random, "z" + std::to_string(change), 90, 70, 8));
        if (zones.size() > 2) zones.erase(zones.begin());
        grids.follow(ground.fence(zones));
        continue;
      }
      for (int i = 0; i < 6; ++i) rows[random() % rows.size()][random() % 90] = "#.. "[random() % 4];
      grids.follow(ground.show(rows, origin));
    }
  }
}

TEST(RobotGrid, ConnectsWhatItConnectsAnew) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    std::mt19937 random(seed);
    ChangingGround ground;
    Rows rows = test::strewn(random, 80, 40, 0.3, 0.02);
    ground.show(rows, {});
    RobotGrids grids(ground.terrain(), 0);
    for (int change = 0; change < 20; ++change) {
      const auto grid = grids.at(0.4, Ignoring::kNothing, *grids.areas().around({10, 10}));
      RobotGrid fresh(ground.terrain(), 0.4, grid->area());
      for (int i = 0; i < 20; ++i) {
        const Cell a{static_cast<std::int32_t>(random() % 80), static_cast<std::int32_t>(random() % 40)};
        const Cell b{static_cast<std::int32_t>(random() % 80), static_cast<std::int32_t>(random() % 40)};
        ASSERT_EQ(grid->paths().connected(a, b), fresh.paths().connected(a, b)) << seed;
      }
      for (int i = 0; i < 10; ++i) rows[random() % rows.size()][random() % 80] = "#. "[random() % 3];
      grids.follow(ground.show(rows, {}));
    }
  }
}

TEST(Areas, WhatLiesFarOffIsAnotherArea) {
  ChangingGround ground;
  ground.show(Rows(20, std::string(30, '.')), {});
  const std::vector<BrickIndex> first = ground.terrain().grid().cells().sorted_bricks();
  RobotGrids grids(ground.terrain(), 0);
  Areas& areas = grids.areas();
  EXPECT_EQ(areas.around({5, 5})->high, (Cell{63, 63}));
  EXPECT_FALSE(areas.around({200, 5}));
  EXPECT_FALSE(areas.together({5, 5}, {200, 5}));
}

/// Two halls 60,000 cells apart: nothing takes memory for what lies between them.
TEST(Plan, HallsFarApartTakeNoMemoryForWhatLiesBetween) {
  BrickMap map;
  VoxelMask all;
  all.fill(~std::uint64_t{0});
  for (const std::int32_t corner : {-3750, 3750}) {
    for (int y = 0; y < 4; ++y) {
      for (int x = 0; x < 4; ++x) map.set({corner + x, corner + y, 0}, Brick::uniform(all, kFree));
    }
  }
  Grid grid(1.0, make_band(0, 1, 1.0).value(), 0.5);
  grid.update(map, map.sorted_bricks());
  const double low = -30'000;
  const double high = 30'000;
  EXPECT_EQ(plan(grid, {low + 3, low + 3}, {low + 28, low + 27}, 1.0).reason, Reason::kOk);
  EXPECT_EQ(plan(grid, {low + 3, low + 3}, {high + 8, high + 7}, 1.0).reason, Reason::kNoValidPath);
  EXPECT_EQ(plan(grid, {high + 3, high + 3}, {high + 28, high + 27}, 1.0).reason, Reason::kOk);
}

}  // namespace
}  // namespace concord
