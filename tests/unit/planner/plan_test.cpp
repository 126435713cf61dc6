#include "planner/plan.hpp"

#include <gtest/gtest.h>

#include "planner/clearance.hpp"
#include "sketch.hpp"

namespace concord {
namespace {

using test::sketch;

Reason reason(const Grid& grid, Eigen::Vector2d start, Eigen::Vector2d goal, double radius) {
  const PlanResult result = plan(grid, start, goal, radius);
  EXPECT_FALSE(result.message.empty());
  EXPECT_EQ(result.points.empty(), result.reason != Reason::kOk);
  return result.reason;
}

const std::vector<std::string> kRoom{
    "############",  //
    "#....#.....#",  //
    "#....#.....#",  //
    "#....#.....#",  //
    "#..........#",  //
    "#....#.....#",  //
    "#....#... .#",  //
    "############",
};

TEST(Plan, ReasonsSayWhatIsWrong) {
  const Grid grid = sketch(kRoom);
  const Eigen::Vector2d left(2.5, 2.5);
  const Eigen::Vector2d right(8.5, 2.5);
  EXPECT_EQ(reason(grid, left, right, 0.4), Reason::kOk);
  EXPECT_EQ(reason(grid, left, right, 0.6), Reason::kNoValidPath);  // the door is one metre wide
  EXPECT_EQ(reason(grid, {-5, 2}, right, 0.4), Reason::kStartOutsideMap);
  EXPECT_EQ(reason(grid, left, {500, 2}, 0.4), Reason::kGoalOutsideMap);
  EXPECT_EQ(reason(grid, left, {1e12, 2}, 0.4), Reason::kGoalOutsideMap);
  EXPECT_EQ(reason(grid, {5.5, 1.5}, right, 0.4), Reason::kStartOccupied);
  EXPECT_EQ(reason(grid, left, {11.5, 2.5}, 0.4), Reason::kGoalOccupied);
  EXPECT_EQ(reason(grid, {9.5, 6.5}, right, 0.4), Reason::kStartUnknown);
  EXPECT_EQ(reason(grid, left, {9.5, 6.5}, 0.4), Reason::kGoalUnknown);
  EXPECT_EQ(reason(grid, {1.3, 2.5}, right, 0.4), Reason::kStartClearance);
  EXPECT_EQ(reason(grid, left, {9.5, 5.7}, 0.4), Reason::kGoalClearance);  // too near to what nobody has seen
  EXPECT_EQ(reason(grid, {NAN, 2.5}, right, 0.4), Reason::kBadRequest);
  EXPECT_EQ(reason(grid, left, {2.5, INFINITY}, 0.4), Reason::kBadRequest);
  EXPECT_EQ(reason(grid, left, right, NAN), Reason::kBadRequest);
  EXPECT_EQ(reason(grid, left, right, -0.1), Reason::kBadRequest);
  EXPECT_EQ(reason(grid, left, right, 1e9), Reason::kBadRequest);
  EXPECT_EQ(reason(sketch({}), left, right, 0.4), Reason::kNoMap);
}

TEST(Plan, EveryReasonHasANameOfItsOwn) {
  std::vector<std::string> names;
  for (int i = 0; i <= static_cast<int>(Reason::kValidationFailed); ++i)
    names.emplace_back(name(static_cast<Reason>(i)));
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

TEST(Plan, GoesRoundTheWallAndEndsWhereItWasAsked) {
  const Grid grid = sketch(kRoom);
  const Eigen::Vector2d start(2.31, 1.52);
  const Eigen::Vector2d goal(8.77, 1.91);
  const PlanResult result = plan(grid, start, goal, 0.45);
  ASSERT_EQ(result.reason, Reason::kOk) << result.message;
  EXPECT_EQ(result.points.front(), start);
  EXPECT_EQ(result.points.back(), goal);
  EXPECT_GT(result.length, 8.0);
  EXPECT_LT(result.length, 9.5);
  EXPECT_GE(result.least_clearance, 0.45 - 1e-5);
  EXPECT_LE(result.least_clearance, 0.5);
}

TEST(Plan, WithAFreeViewTheWayIsStraight) {
  const Grid grid = sketch(std::vector<std::string>(50, std::string(60, '.')));
  const PlanResult result = plan(grid, {13.2, 14.1}, {43.3, 31.7}, 2.0);
  ASSERT_EQ(result.reason, Reason::kOk);
  EXPECT_EQ(result.points.size(), 2U);
  EXPECT_NEAR(result.least_clearance, 13.2, 1e-9);
  const PlanResult nowhere = plan(grid, {3.2, 4.1}, {3.2, 4.1}, 2.0);
  ASSERT_EQ(nowhere.reason, Reason::kOk);
  EXPECT_EQ(nowhere.length, 0.0);
}

TEST(Plan, AnEndThatIsShutInIsFoundSoWithoutASearch) {
  std::vector<std::string> rows(1000, std::string(1000, '.'));
  for (int i = 0; i <= 20; ++i) rows[500][500 + i] = rows[520][500 + i] = rows[500 + i][500] = rows[500 + i][520] = '#';
  const Grid grid = sketch(rows);
  for (const auto& [start, goal] :
       {std::pair(Eigen::Vector2d(2, 2), Eigen::Vector2d(510, 510)), {{510, 510}, {2, 2}}}) {
    const PlanResult result = plan(grid, start, goal, 0.4);
    EXPECT_EQ(result.reason, Reason::kNoValidPath);
    EXPECT_EQ(result.expanded, 0);
  }
}

TEST(Plan, DoesNotSlipThroughACornerOrUnknownSpace) {
  const Grid corner = sketch({"..#", ".#.", "#.."});
  EXPECT_EQ(reason(corner, {0.5, 0.5}, {2.5, 2.5}, 0.0), Reason::kNoValidPath);
  const Grid touching = sketch({".#", "#."});
  EXPECT_EQ(reason(touching, {0.5, 0.5}, {1.5, 1.5}, 0.0), Reason::kNoValidPath);
  const Grid unknown = sketch({"... ...", "... ...", "... ..."});
  EXPECT_EQ(reason(unknown, {0.5, 1.5}, {6.5, 1.5}, 0.0), Reason::kBlockedByUnknown);
}

/// Each point of the way, every twentieth of a cell, has the robot's radius around it free.
void expect_safe(const Grid& grid, const PlanResult& result, double radius) {
  const double r = grid.resolution();
  double least = radius / r + 4;
  for (std::size_t i = 1; i < result.points.size(); ++i) {
    const Eigen::Vector2d step = result.points[i] - result.points[i - 1];
    const int samples = static_cast<int>(step.norm() / r * 20) + 1;
    for (int k = 0; k <= samples; ++k) {
      const Eigen::Vector2d p = (result.points[i - 1] + step * k / samples) / r;
      least = std::min(least, test::nearest_blocked(grid, p.x(), p.y(), least));
    }
  }
  EXPECT_GE(least * r, radius - 1e-5 * r);
  EXPECT_GT(least, 0.0);
  EXPECT_GE(least * r, std::min(result.least_clearance, radius + 4 * r) - 1e-9);
  if (result.least_clearance < radius + 3 * r) {
    EXPECT_NEAR(least * r, result.least_clearance, 0.05 * r);
  }
}

/// At 0.05 and 0.1 m lengths in metres are no whole numbers of cells, as they are at 1 m: radii come in steps of 1 cm.
class PlanAt : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Resolutions, PlanAt, testing::Values(0.05, 0.1, 1.0), [](const auto& resolution) {
  return std::to_string(std::lround(resolution.param * 100)) + "cm";
});

TEST_P(PlanAt, EveryRadiusHasItsPathAndItsClearanceIsMeasured) {
  const double r = GetParam();
  const Grid grid = sketch(std::vector<std::string>(60, std::string(90, '.')), {-20, -10}, r);
  const Eigen::Vector2d start(5 * r, 20 * r);
  const Eigen::Vector2d goal(45 * r, 22 * r);
  for (int cm = 0; 0.01 * cm <= std::min(25 * r, kMaxRadius); ++cm) {
    const double radius = 0.01 * cm;
    const PlanResult result = plan(grid, start, goal, radius);
    ASSERT_EQ(result.reason, Reason::kOk) << cm << " cm: " << result.message;
    ASSERT_NEAR(result.least_clearance, 25 * r, 1e-9) << cm << " cm";
  }
}

TEST_P(PlanAt, EveryPathIsSafeAndNoneIsMissed) {
  const double r = GetParam();
  int found = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    const Cell origin{static_cast<std::int32_t>(random() % 128) - 64, static_cast<std::int32_t>(random() % 128) - 64};
    const Grid grid =
        sketch(test::strewn(random, 50, 40, 0.02 + 0.001 * static_cast<double>(random() % 150), 0.01), origin, r);
    const int widest = static_cast<int>(180 * r);
    const double radius = seed % 3 == 0 ? 0.0 : 0.01 * static_cast<double>(random() % (widest + 1));
    const auto anywhere = [&] {
      return Eigen::Vector2d((origin.x + 0.01 * static_cast<double>(random() % 5000)) * r,
                             (origin.y + 0.01 * static_cast<double>(random() % 4000)) * r);
    };
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector2d start = anywhere();
      const Eigen::Vector2d goal = anywhere();
      const PlanResult result = plan(grid, start, goal, radius);
      const PlanResult back = plan(grid, goal, start, radius);
      ASSERT_NE(result.reason, Reason::kValidationFailed) << "seed " << seed;
      ASSERT_EQ(result.reason == Reason::kOk, back.reason == Reason::kOk) << "seed " << seed;
      for (const auto& [end, reason] : {std::pair(start, Reason::kStartClearance), {goal, Reason::kGoalClearance}}) {
        if (result.reason != reason || result.message.find("narrow") != std::string::npos) continue;
        EXPECT_LE(test::nearest_blocked(grid, end.x() / r, end.y() / r, radius / r + 1), radius / r + 1e-6);
      }
      if (result.reason != Reason::kOk) continue;
      ++found;
      ASSERT_EQ(result.points.front(), start);
      ASSERT_EQ(result.points.back(), goal);
      ASSERT_GE(result.length, (goal - start).norm() - 1e-9);
      expect_safe(grid, result, radius);
      if (HasFailure())
        FAIL() << "seed " << seed << " r " << radius << " " << start.transpose() << " to " << goal.transpose();
    }
  }
  EXPECT_GT(found, 500);
}

TEST(Plan, DoesNotDependOnTheOrderTheMapCameIn) {
  std::mt19937 random(3);
  const std::vector<std::string> rows = test::strewn(random, 100, 100, 0.2, 0.02);
  const Grid grid = sketch(rows);
  Grid shuffled(1.0, make_band(0, 1, 1.0).value(), 0.5);
  std::vector<BrickIndex> bricks = grid.cells().sorted_bricks();
  std::shuffle(bricks.begin(), bricks.end(), random);
  BrickMap map;
  for (const BrickIndex b : bricks) {
    map.set(b, *grid.cells().find(b));
    shuffled.update(map, {&b, 1});
  }
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d start(static_cast<double>(random() % 100) + 0.5, static_cast<double>(random() % 100) + 0.5);
    const Eigen::Vector2d goal(static_cast<double>(random() % 100) + 0.5, static_cast<double>(random() % 100) + 0.5);
    const PlanResult a = plan(grid, start, goal, 0.4);
    const PlanResult b = plan(shuffled, start, goal, 0.4);
    ASSERT_EQ(a.reason, b.reason);
    ASSERT_EQ(a.message, b.message);
    ASSERT_EQ(a.points, b.points);
  }
}

TEST(Validator, FindsWhatIsWrongWithAPath) {
  const Grid grid = sketch(kRoom);
  const std::vector<Eigen::Vector2d> through_wall{{2.5, 2.5}, {8.5, 2.5}};
  const std::vector<Eigen::Vector2d> through_door{{2.5, 4.5}, {8.5, 4.5}};
  const std::vector<Eigen::Vector2d> along_wall{{2.5, 4.1}, {8.5, 4.1}};
  EXPECT_FALSE(is_clear(grid, through_wall, 0.0));
  EXPECT_TRUE(is_clear(grid, through_door, 0.5));
  EXPECT_FALSE(is_clear(grid, through_door, 0.51));
  EXPECT_TRUE(is_clear(grid, along_wall, 0.09));
  EXPECT_FALSE(is_clear(grid, along_wall, 0.11));
  EXPECT_NEAR(clearance(grid, along_wall, 2).value(), 0.1, 1e-12);
  EXPECT_FALSE(clearance(grid, along_wall, 0.1 - 1e-9));
  EXPECT_EQ(clearance(grid, through_wall, 2), 0.0);
  const std::vector<Eigen::Vector2d> over_a_corner{{4.5, 3.5}, {5.5, 4.5}};
  EXPECT_FALSE(is_clear(grid, over_a_corner, 0.0));
}

}  // namespace
}  // namespace concord
