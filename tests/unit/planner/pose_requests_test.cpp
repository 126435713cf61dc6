// What requests of robots that are not round are answered.
#include "active_poses.hpp"

namespace concord {
namespace {

using test::two_rooms;
using test::with_box;

class PoseRequests : public test::ActivePoses {};

TEST_F(PoseRequests, AFootprintGetsAPathOfPoses) {
  show(two_rooms());
  const Path path = ask(across("p1"), fork_lift());
  ASSERT_EQ(path.status, "OK") << path.message;
  EXPECT_TRUE(path.active);
  EXPECT_EQ(path.footprint.size(), 4U);
  EXPECT_EQ(path.turn_radius, 0.4);
  EXPECT_EQ(path.details.front().yaw, 0.0);
  EXPECT_EQ(path.details.back().yaw, M_PI / 2);
  EXPECT_EQ(path.map_revision, revision_);
  EXPECT_GT(path.details.back().eta, path.length / 0.5 * 0.99);
  EXPECT_GT(path.least_clearance, 0);
  EXPECT_TRUE(is_valid(path));
  // Asked again by the same id it is the same.
  EXPECT_EQ(planner_.request(across("p1"), fork_lift(), now()).path->path_id, path.path_id);
}
TEST_F(PoseRequests, CancelEndsASearchThatIsUnderWayAndOneThatWaits) {
  show(two_rooms());
  planner_.serve(now());
  ASSERT_FALSE(planner_.request(across("p1"), fork_lift(), now()).path);
  const auto quest = planner_.next_quest();
  ASSERT_NE(quest, nullptr);
  auto ended = planner_.cancel("robot1", now());
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_EQ(ended[0].path.status, "CANCELLED");
  EXPECT_FALSE(ended[0].was_answered);
  quest->run();
  EXPECT_EQ(quest->legs().back().outcome, PoseOutcome::kStopped);
  EXPECT_TRUE(planner_.serve(now()).empty());

  ASSERT_FALSE(planner_.request(across("p2"), fork_lift(), now()).path);
  EXPECT_EQ(planner_.cancel("robot1", now()).size(), 1U);
  EXPECT_EQ(planner_.next_quest(), nullptr);
}

TEST_F(PoseRequests, OthersNeedNotWaitForASearch) {
  show(two_rooms());
  planner_.serve(now());
  ASSERT_FALSE(planner_.request(across("p1"), fork_lift(), now()).path);
  PathRequest round = across("p2");
  round.robot = "robot2";
  const auto reply = planner_.request(round, {0.3}, now());
  ASSERT_TRUE(reply.path);
  EXPECT_EQ(reply.path->status, "OK");
}

TEST_F(PoseRequests, OtherRobotsStandInTheWayAndTheRobotItselfDoesNot) {
  show(two_rooms());
  planner_.set_pose("robot1", {3, 2.5}, 0.8, 0.5);
  planner_.set_pose("robot2", {10.1, 2.4}, 0.8);
  PathRequest request = across("p1");
  request.start.reset();
  request.goal_yaw.reset();
  const Path path = ask(request, fork_lift());
  ASSERT_EQ(path.status, "OK") << path.message;
  EXPECT_EQ(path.details.front().yaw, 0.5) << "as the robot points";
  double highest = 0;
  for (const Eigen::Vector3d& p : path.points) highest = std::max(highest, p.y());
  EXPECT_GT(highest, 8) << "by the other door";
  EXPECT_TRUE(is_valid(path));
}

TEST_F(PoseRequests, ByWayOfWaypointsAndTheOneThatFailsIsNamed) {
  show(two_rooms());
  PathRequest request = across("p1");
  request.waypoints = {{6, 9}, {14, 9.5}};
  const Path path = ask(request, fork_lift());
  ASSERT_EQ(path.status, "OK") << path.message;
  EXPECT_EQ(path.details.back().leg, 2);
  EXPECT_TRUE(is_valid(path));
  for (const Eigen::Vector2d& waypoint : request.waypoints) {
    double least = 10;
    for (const Eigen::Vector3d& p : path.points) least = std::min(least, (p.head<2>() - waypoint).norm());
    EXPECT_LT(least, 1e-9);
  }
  request.id = "p2";
  request.waypoints[1] = {10.1, 5};  // in the wall
  const Path failed = ask(request, fork_lift());
  EXPECT_EQ(failed.status, "WAYPOINT_UNREACHABLE");
  EXPECT_EQ(failed.failed_leg, 1);
  EXPECT_NE(failed.message.find("waypoint 2"), std::string::npos) << failed.message;
}

TEST_F(PoseRequests, WhatCannotBeIsSaidClearly) {
  show(two_rooms());
  const auto status = [&](const PathRequest& request, const Robot& robot) {
    const Path path = ask(request, robot);
    EXPECT_FALSE(path.message.empty());
    return path.status;
  };
  EXPECT_EQ(status(across("wide"), fork_lift(3, 2.6, 0)), "NO_VALID_PATH") << "wider than every door";
  PathRequest request = across("nan");
  request.goal = {NAN, 1};
  EXPECT_EQ(status(request, fork_lift()), "BAD_REQUEST");
  request = across("yaw");
  request.goal_yaw = INFINITY;
  EXPECT_EQ(status(request, fork_lift()), "BAD_REQUEST");
  request = across("far");
  request.goal = {9'999, 1};
  EXPECT_EQ(status(request, fork_lift()), "GOAL_OUTSIDE_MAP");
  request = across("wall");
  request.goal = {10.1, 5};
  EXPECT_EQ(status(request, fork_lift()), "GOAL_OCCUPIED");
  request = across("corner");
  request.goal = {19.5, 11.5};
  EXPECT_EQ(status(request, fork_lift()), "GOAL_CLEARANCE");
  request = across("crossed");
  request.footprint = {{1, 1}, {-1, -1}, {1, -1}, {-1, 1}};
  EXPECT_EQ(status(request, {0.3}), "BAD_REQUEST");
  request = across("radius");
  request.radius = 0.3;
  EXPECT_EQ(status(request, fork_lift()), "BAD_REQUEST") << "it is not a disc";
  request = across("many");
  request.waypoints.assign(1000, Eigen::Vector2d(5, 5));
  EXPECT_EQ(status(request, fork_lift()), "BAD_REQUEST");
  request = across("turn");
  request.footprint = {{1, 0.4}, {-1, 0.4}, {-1, -0.4}, {1, -0.4}};
  request.turn_radius = 1e-9;
  EXPECT_EQ(status(request, {0.3}), "BAD_REQUEST");
  request.id = "own";
  request.turn_radius = 0;
  EXPECT_EQ(status(request, {0.3}), "OK") << "the request's own footprint";
}

TEST_F(PoseRequests, AZoneThatCutsTheWayOffIsNamed) {
  show(two_rooms());
  const std::vector<Zone> zones{test::no_go("upper", {9.5, 1.6}, {10.5, 3.4}),
                                test::no_go("lower", {9.5, 8.6}, {10.5, 10.4})};
  planner_.set_zones(zones);
  const Path path = ask(across("p1"), fork_lift());
  EXPECT_EQ(path.status, "NO_VALID_PATH");
  EXPECT_NE(path.message.find("'upper'"), std::string::npos) << path.message;
}

}  // namespace
}  // namespace concord
