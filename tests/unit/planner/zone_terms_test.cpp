// Margins, costs and corridors: planner/README.md states the rules.
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "planner/plan.hpp"
#include "planner/planner.hpp"
#include "sketch.hpp"
#include "zones.hpp"

namespace concord {
namespace {

using Rows = std::vector<std::string>;

const Band kBand = make_band(0, 1, 1.0).value();
const Rows kHall(30, std::string(60, '.'));

ZoneLayer layer_of(const std::vector<Zone>& zones) {
  ZoneLayer layer(1.0, kBand);
  layer.set(zones);
  return layer;
}

std::set<Cell> cells_of(const ZoneCells& zone) {
  std::set<Cell> cells;
  for (const ColumnPlane& plane : zone.columns) {
    for (int i = 0; i < 64; ++i) {
      if ((plane.cells >> i & 1) != 0) cells.insert({plane.column.x * 8 + (i & 7), plane.column.y * 8 + (i >> 3)});
    }
  }
  return cells;
}

TEST(ZoneMargin, TakesExactlyTheCellsNearerThanItSaysAndCountsNoFewer) {
  constexpr std::int64_t kMost = 1'000'000;
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Zone zone = test::random_zone(random, "z", 20, 20, 6);
    zone.kind = Zone::Kind::kNoGo;
    const auto bare = draw(zone, 1.0, kBand, kMost);
    ASSERT_TRUE(bare);
    zone.margin = 0.5 * static_cast<double>(random() % 12);
    const auto wide = draw(zone, 1.0, kBand, kMost);
    ASSERT_TRUE(wide);
    const std::set<Cell> inner = cells_of(*bare), outer = cells_of(*wide);
    std::set<Cell> wanted = inner;
    for (const Cell cell : inner) {
      for (int dy = -8; dy <= 8; ++dy) {
        for (int dx = -8; dx <= 8; ++dx) {
          const double apart = std::hypot(std::max(std::abs(dx) - 1, 0), std::max(std::abs(dy) - 1, 0));
          if (apart < zone.margin) wanted.insert({cell.x + dx, cell.y + dy});
        }
      }
    }
    ASSERT_EQ(outer, wanted);
    ASSERT_EQ(wide->count, static_cast<std::int64_t>(outer.size()));
    ASSERT_GE(*count(zone, 1.0, kBand, kMost), wide->count);
    const CellRectangle around = rectangle_around(zone, 1.0, kBand);
    for (const Cell cell : outer) ASSERT_TRUE(around.holds(cell) && wide->bounds.holds(cell));
  }
}

TEST(ZoneMargin, ThatMakesItTooLargeIsARectangleAroundAll) {
  Zone zone = test::no_go("yard", {0, 0}, {990, 990});
  zone.margin = 10;
  const ZoneLayer layer = layer_of({zone});
  EXPECT_EQ(layer.coarse(), std::vector<std::string>{"yard"});
  EXPECT_NE(layer.no_go_at({-10, 500}), nullptr);
  EXPECT_NE(layer.no_go_at({-10, -10}), nullptr);
  EXPECT_EQ(layer.no_go_at({-13, 500}), nullptr);
}

double highest(const PlanResult& plan) {
  double most = 0;
  for (const Eigen::Vector2d& p : plan.points) most = std::max(most, p.y());
  return most;
}

TEST(CostlyZone, IsGoneRoundWhereThatIsCheaperAndThroughWhereItIsNot) {
  const Grid grid = test::sketch(kHall);
  const Eigen::Vector2d from(5, 14.5), to(55, 14.5);
  const auto with = [&](int cost, double margin) {
    return plan({grid, layer_of({test::costly("wet floor", {25, 9}, {35, 17.9}, cost, margin)})}, from, to, 0.4);
  };
  const PlanResult cheap = with(1, 0), dear = with(15, 0);
  ASSERT_EQ(dear.reason, Reason::kOk) << dear.message;
  EXPECT_GT(highest(dear), 17.9);
  EXPECT_LT(dear.length, 54);
  ASSERT_EQ(cheap.reason, Reason::kOk);
  EXPECT_GT(highest(with(15, 3)), highest(dear) + 2) << "its margin, too";
  // Where there is no other way, it is gone through.
  const PlanResult through = plan({grid, layer_of({test::costly("gate", {25, -5}, {35, 40}, 15)})}, from, to, 0.4);
  ASSERT_EQ(through.reason, Reason::kOk);
  EXPECT_LT(through.length, 51);
}

TEST(Corridors, ForceAPath) {
  const Grid grid = test::sketch(kHall);
  const Eigen::Vector2d from(8, 4), to(50, 4);
  EXPECT_LT(plan(grid, from, to, 0.4).length, 46);
  // Up, across and down again, five metres wide.
  const std::vector<Zone> zones{test::corridor("a", {6, 2}, {11, 25}), test::corridor("b", {6, 20}, {53, 25}),
                                test::corridor("c", {48, 2}, {53, 25})};
  const PlanResult forced = plan({grid, layer_of(zones)}, from, to, 0.4);
  ASSERT_EQ(forced.reason, Reason::kOk) << forced.message;
  EXPECT_GT(forced.length, 60);
  for (std::size_t i = 1; i < forced.points.size(); ++i) {
    for (int k = 0; k <= 100; ++k) {
      const Eigen::Vector2d p = forced.points[i - 1] + (forced.points[i] - forced.points[i - 1]) * k / 100;
      const bool inside = std::any_of(zones.begin(), zones.end(), [&](const Zone& zone) {
        const Box& box = std::get<Box>(zone.volume);
        return p.x() >= box.min.x() - 1 && p.x() <= box.max.x() + 1 && p.y() >= box.min.y() - 1 &&
               p.y() <= box.max.y() + 1;
      });
      ASSERT_TRUE(inside) << p.transpose();
    }
  }
  // From beside it the path comes in by the shortest way; it is no wall.
  EXPECT_EQ(plan({grid, layer_of(zones)}, {30, 4}, to, 0.4).reason, Reason::kOk);
}

TEST(Costs, AreWhatTheZonesSayWhateverWasBefore) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    ZoneLayer layer(1.0, kBand);
    std::vector<Zone> zones;
    for (int step = 0; step < 12; ++step) {
      if (!zones.empty() && random() % 3 == 0)
        zones.erase(zones.begin() + static_cast<std::ptrdiff_t>(random() % zones.size()));
      Zone zone = test::random_zone(random, "z" + std::to_string(random() % 8), 40, 40, 8);
      zone.kind = static_cast<Zone::Kind>(random() % 4);
      zone.cost = zone.kind == Zone::Kind::kCostly ? 1 + static_cast<int>(random() % 15) : 0;
      std::erase_if(zones, [&](const Zone& old) { return old.name == zone.name; });
      zones.push_back(zone);
      std::vector<ColumnCosts> before;
      const auto costs = [](const ZoneLayer& of) {
        std::vector<ColumnCosts> all;
        for (int y = -3; y < 9; ++y) {
          for (int x = -3; x < 9; ++x) all.push_back(of.costs({x, y, 0}));
        }
        return all;
      };
      before = costs(layer);
      const ZoneLayer::Change change = layer.set(zones);
      const std::vector<ColumnCosts> after = costs(layer);
      ASSERT_EQ(after, costs(layer_of(zones)));
      if (change.anywhere) continue;
      std::size_t i = 0;
      for (int y = -3; y < 9; ++y) {
        for (int x = -3; x < 9; ++x, ++i) {
          const auto told = std::find_if(change.columns.begin(), change.columns.end(), [&](const ColumnChange& c) {
            return c.column == BrickIndex{x, y, 0};
          });
          ASSERT_TRUE(after[i] == before[i] || told != change.columns.end());
        }
      }
    }
  }
}

TEST(Costs, OfAZoneThatComesTurnAKeptPathAside) {
  Planner planner(Grid(1.0, kBand, 0.5));
  planner.set_zones({});
  const Grid grid = test::sketch(kHall);
  grid.cells().for_each_brick([&](BrickIndex index, const Brick& brick) { planner.set_brick(index, brick); });
  planner.project();
  PathRequest request;
  request.id = "p1";
  request.robot = "robot1";
  request.start = Eigen::Vector2d(5, 14.5);
  request.goal = {55, 14.5};
  request.keep_active = true;
  planner.serve({1, 1'000'000});
  const auto reply = planner.request(request, {0.4}, {1, 1'000'000});
  ASSERT_TRUE(reply.path && reply.path->status == "OK");
  const std::vector<Zone> zones{test::costly("wet floor", {25, 3}, {35, 26}, 15)};
  planner.set_zones(zones);
  planner.serve({2, 2'000'000});
  const std::vector<Path> aside = planner.replan({2, 2'000'000});
  ASSERT_EQ(aside.size(), 1U);
  EXPECT_EQ(aside[0].status, "OK");
  EXPECT_GT(aside[0].length, reply.path->length + 0.5);
  planner.set_zones({});
  for (int i = 0; i < 3; ++i) {  // what became cheaper is looked for when there is time
    planner.serve({3, 4'000'000 + i * 2'000'000});
    (void)planner.replan({3, 4'000'000 + i * 2'000'000});
  }
  const Path last = planner.kept().front();
  EXPECT_EQ(last.status, "OK");
  EXPECT_NEAR(last.length, reply.path->length, 0.1) << "it goes straight again, not " << aside[0].length;
}

TEST(Costs, OfAZoneThatComesTurnAMovingRobotAside) {
  Planner planner(Grid(1.0, kBand, 0.5));
  planner.set_zones({});
  const Grid grid = test::sketch(kHall);
  grid.cells().for_each_brick([&](BrickIndex index, const Brick& brick) { planner.set_brick(index, brick); });
  planner.project();
  planner.set_pose("robot1", {5, 14.5});
  PathRequest request;
  request.id = "p1";
  request.robot = "robot1";
  request.goal = {55, 14.5};
  request.keep_active = true;
  planner.serve({1, 1'000'000});
  const auto reply = planner.request(request, {0.4}, {1, 1'000'000});
  ASSERT_TRUE(reply.path && reply.path->status == "OK");
  planner.set_pose("robot1", {9, 14.5});
  planner.set_zones(std::vector<Zone>{test::costly("wet floor", {25, 9}, {35, 17.9}, 15)});
  planner.serve({2, 2'000'000});
  const std::vector<Path> aside = planner.replan({2, 2'000'000});
  ASSERT_EQ(aside.size(), 1U);
  EXPECT_EQ(aside[0].status, "OK");
  EXPECT_GT(aside[0].length, reply.path->length - 4 + 0.5);
}

TEST(Costs, CorridorsOfAnotherStoreyAreNone) {
  Zone upstairs = test::costly("upstairs", {5, 5}, {35, 10}, 0);
  upstairs.kind = Zone::Kind::kCorridor;
  upstairs.T_map_zone.translation().z() = 50;
  EXPECT_EQ(layer_of({upstairs}).costs({0, 0, 0}), ColumnCosts{});
  upstairs.T_map_zone.translation().z() = 0;
  EXPECT_NE(layer_of({upstairs}).costs({5, 5, 0}), ColumnCosts{});
}

}  // namespace
}  // namespace concord
