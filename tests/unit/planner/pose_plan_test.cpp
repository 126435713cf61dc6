#include "planner/pose_plan.hpp"

#include <gtest/gtest.h>

#include "planner/se2/pose_check.hpp"
#include "sketch.hpp"
#include "zones.hpp"

namespace concord {
namespace {

/// Two rooms of half-metre cells and a door of six cells between them; a corner that nobody has seen.
Grid rooms(Cell origin = {}) {
  std::vector<std::string> rows(30, std::string(60, '.'));
  for (std::size_t y = 0; y < rows.size(); ++y) {
    for (std::size_t x = 0; x < rows[y].size(); ++x) {
      if (y == 0 || x == 0 || y == 29 || x == 59 || (x == 30 && (y < 12 || y >= 18))) rows[y][x] = '#';
      if (y > 24 && x > 54 && y < 29 && x < 59) rows[y][x] = ' ';
    }
  }
  return test::sketch(rows, origin, 0.5);
}

const Pose kLeft{{5, 5}, 0.3}, kRight{{24, 9}, -2};

PosePlan ask(const Grid& grid, const Footprint& footprint, const Pose& start, const Pose& goal,
             const ZoneLayer& zones = no_zones(), double turn_radius = 0.8) {
  PosePlanner planner(grid, zones, footprint, turn_radius);
  PosePlan plan = planner.plan(start, goal, 7, [] { return false; });
  EXPECT_FALSE(plan.message.empty());
  EXPECT_EQ(plan.poses.empty(), plan.reason != Reason::kOk);
  EXPECT_EQ(plan.clearance.size(), plan.poses.size());
  return plan;
}

TEST(PosePlan, GoesThroughTheDoor) {
  const Footprint footprint = *make_rectangle(1.2, 0.8);
  // A frame's origin anywhere.
  for (const Cell origin : {Cell{0, 0}, Cell{-1000, 37}}) {
    const Grid grid = rooms(origin);
    const Eigen::Vector2d shift(origin.x * 0.5, origin.y * 0.5);
    const Pose start{kLeft.p + shift, kLeft.yaw}, goal{kRight.p + shift, kRight.yaw};
    const PosePlan plan = ask(grid, footprint, start, goal);
    ASSERT_EQ(plan.reason, Reason::kOk) << plan.message;
    EXPECT_EQ(plan.map_revision, 7);
    EXPECT_EQ(plan.poses.front().p, start.p);
    EXPECT_EQ(plan.poses.back().yaw, goal.yaw);
    EXPECT_GT(plan.length, (goal.p - start.p).norm());
    EXPECT_LT(plan.length, 1.5 * (goal.p - start.p).norm());
    EXPECT_GT(plan.least_clearance, 0);
    EXPECT_LE(plan.least_clearance, 1.1);  // the door is 3 m wide
  }
}

TEST(PosePlan, ReasonsSayWhatIsWrong) {
  const Grid grid = rooms();
  const Footprint footprint = *make_rectangle(1.2, 0.8);
  const auto reason = [&](const Pose& start, const Pose& goal) { return ask(grid, footprint, start, goal).reason; };
  EXPECT_EQ(reason({{NAN, 1}, 0}, kRight), Reason::kBadRequest);
  EXPECT_EQ(reason(kLeft, {{5, 5}, INFINITY}), Reason::kBadRequest);
  EXPECT_EQ(reason({{-1, 5}, 0}, kRight), Reason::kStartOutsideMap);
  EXPECT_EQ(reason(kLeft, {{10'000, 5}, 0}), Reason::kGoalOutsideMap);
  EXPECT_EQ(reason(kLeft, {{1e300, 5}, 0}), Reason::kGoalOutsideMap);
  EXPECT_EQ(reason({{15.2, 2}, 0}, kRight), Reason::kStartOccupied);
  EXPECT_EQ(reason(kLeft, {{0.2, 2}, 0}), Reason::kGoalOccupied);
  EXPECT_EQ(reason({{28, 13}, 0}, kRight), Reason::kStartUnknown);
  EXPECT_EQ(reason(kLeft, {{28, 13}, 0}), Reason::kGoalUnknown);
  EXPECT_EQ(reason({{1, 5}, 0}, kRight), Reason::kStartClearance);
  EXPECT_EQ(reason({{1, 5}, M_PI / 2}, kRight), Reason::kOk);
  EXPECT_EQ(reason(kLeft, {{29.0, 5}, 0}), Reason::kGoalClearance);
  EXPECT_EQ(ask(grid, *make_rectangle(4, 3.6), {{6, 5}, 0}, {{24, 7}, 0}).reason, Reason::kNoValidPath);
  for (const double bad : {-1.0, double{NAN}, 1e-9, 1e9}) {
    EXPECT_EQ(ask(grid, footprint, kLeft, kRight, no_zones(), bad).reason, Reason::kBadRequest) << bad;
  }
  EXPECT_EQ(ask(test::sketch({}), footprint, kLeft, kRight).reason, Reason::kNoMap);
  PosePlanner planner(grid, no_zones(), footprint, 0.8);
  EXPECT_TRUE(planner.plan(kLeft, kRight, 0, [] { return true; }).stopped);
}

TEST(PosePlan, AMapThatIsTooBigIsRefused) {
  Grid grid = test::sketch({"........", "........"}, {-30'000, 0}, 0.05);
  BrickMap far;
  DenseBrick free;
  free.fill(kFree);
  far.set({3000, 3000, 0}, Brick::from_dense(free));
  far.set({-3000, -3000, 0}, Brick::from_dense(free));
  grid.update(far, far.sorted_bricks());
  const Pose pose{{3000 * 8 * 0.05 + 0.2, 3000 * 8 * 0.05 + 0.2}, 0};
  EXPECT_EQ(ask(grid, *make_rectangle(0.1, 0.1), pose, pose).reason, Reason::kSearchLimit);
}

TEST(PosePlan, NoGoZonesAreWalls) {
  const Grid grid = rooms();
  ZoneLayer zones(grid.resolution(), grid.band());
  const std::vector<Zone> shut{test::no_go("door", {14, 6}, {16, 9})};
  PosePlanner planner(grid, zones, *make_rectangle(1.2, 0.8), 0);
  const auto never = [] { return false; };
  EXPECT_EQ(planner.plan(kLeft, kRight, 1, never).reason, Reason::kOk);
  const auto columns = [](const ZoneLayer::Change& change) {
    std::vector<BrickIndex> touched;
    for (const ColumnChange& c : change.columns) touched.push_back(c.column);
    return touched;
  };
  planner.update(columns(zones.set(shut)));
  EXPECT_EQ(planner.plan(kLeft, kRight, 2, never).reason, Reason::kNoValidPath);
  EXPECT_EQ(planner.plan(kLeft, {{15.2, 7.5}, 0}, 2, never).reason, Reason::kGoalInNoGo);
  planner.update(columns(zones.set({})));
  EXPECT_EQ(planner.plan(kLeft, kRight, 3, never).reason, Reason::kOk);
}

}  // namespace
}  // namespace concord
