#include "planner/route.hpp"

#include <gtest/gtest.h>

#include "planner/clearance.hpp"
#include "planner/plan.hpp"
#include "sketch.hpp"

namespace concord {
namespace {

constexpr std::int64_t kAll = std::numeric_limits<std::int64_t>::max();

const std::vector<std::string> kRooms{
    "###############",  //
    "#......#......#",  //
    "#......#......#",  //
    "#.............#",  //
    "#......#......#",  //
    "#......########",  //
    "#......#......#",  //
    "#......#......#",  //
    "###############",
};

class Routes : public testing::Test {
 protected:
  Grid grid_ = test::sketch(kRooms);
  RobotGrids grids_{grid_, 0};
  RobotTask task_{grids_, 0.4};
};

TEST_F(Routes, GoByWayOfAllWaypointsInTheirOrder) {
  const std::vector<Eigen::Vector2d> waypoints{{10.5, 2.5}, {2.5, 6.5}};
  Route route({2.5, 2.5}, waypoints, {12.5, 3.5});
  const PlanResult result = finish(task_, *route.find(task_, kAll));
  ASSERT_EQ(result.reason, Reason::kOk) << result.message;
  ASSERT_EQ(result.legs.size(), result.points.size());
  EXPECT_TRUE(std::is_sorted(result.legs.begin(), result.legs.end()));
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    const auto at = std::find(result.points.begin(), result.points.end(), waypoints[i]);
    ASSERT_NE(at, result.points.end());
    EXPECT_EQ(result.legs[static_cast<std::size_t>(at - result.points.begin())], static_cast<std::int32_t>(i));
  }
  EXPECT_EQ(result.legs.back(), 2);
  EXPECT_EQ(result.points.back(), Eigen::Vector2d(12.5, 3.5));
}

TEST_F(Routes, NameTheLegThatFails) {
  const std::vector<Eigen::Vector2d> waypoints{{10.5, 2.5}, {10.5, 6.5}, {3.5, 6.5}};
  Route route({2.5, 2.5}, waypoints, {12.5, 3.5});
  const auto found = route.find(task_, kAll);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->way.reason, Reason::kWaypointUnreachable);
  EXPECT_EQ(found->legs, std::vector<std::int32_t>{1});
  EXPECT_TRUE(found->way.message.starts_with("waypoint 2 cannot be reached")) << found->way.message;
  Route last({2.5, 2.5}, std::vector<Eigen::Vector2d>{{10.5, 2.5}}, {10.5, 6.5});
  EXPECT_EQ(last.find(task_, kAll)->way.reason, Reason::kNoValidPath);
  Route wall({2.5, 2.5}, std::vector<Eigen::Vector2d>{{7.5, 2.5}}, {10.5, 2.5});
  EXPECT_EQ(wall.find(task_, kAll)->way.reason, Reason::kWaypointUnreachable);
}

TEST_F(Routes, AThousandWaypointsComeInPartsThatAreShort) {
  std::vector<Eigen::Vector2d> waypoints;
  for (int i = 0; i < 1000; ++i) waypoints.emplace_back(i % 2 == 0 ? 10.5 : 2.5, 2.5);
  Route route({2.5, 2.5}, waypoints, {12.5, 3.5});
  int calls = 1;
  auto found = route.find(task_, 200'000);
  for (; !found; found = route.find(task_, 200'000)) {
    EXPECT_LT(route.expanded(), 250'000);
    ++calls;
  }
  EXPECT_GT(calls, 2);
  const PlanResult result = finish(task_, *found);
  ASSERT_EQ(result.reason, Reason::kOk);
  EXPECT_EQ(result.legs.back(), 1000);
}

TEST_F(Routes, LeaveBehindWhatTheRobotHasPassed) {
  Route route({2.5, 2.5}, std::vector<Eigen::Vector2d>{{5.5, 2.5}}, {12.5, 3.5});
  ASSERT_TRUE(route.find(task_, kAll));
  route.pass({4.5, 2.5}, 0.5);
  EXPECT_EQ(route.waypoints_left().size(), 1U);
  route.pass({5.4, 2.5}, 0.5);
  EXPECT_TRUE(route.waypoints_left().empty());
  const auto found = route.follow(task_, {}, Eigen::Vector2d(6.2, 3.3));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->way.points.front(), Eigen::Vector2d(6.2, 3.3));
  EXPECT_TRUE(found->way.is_kept);
  EXPECT_FALSE(route.follow(task_, {}, Eigen::Vector2d(3.5, 7.5))) << "it is not on its way any more";
}

}  // namespace
}  // namespace concord
