// Kept paths of robots that are not round: searches run beside the planner, here whenever the test has them run.
#include <random>

#include <gtest/gtest.h>

#include "planner/planner.hpp"
#include "planner/se2/pose_check.hpp"
#include "sketch.hpp"
#include "zones.hpp"

namespace concord {
namespace {

using Rows = std::vector<std::string>;
constexpr std::int64_t kSecond = 1'000'000;

/// Quarter-metre cells: two rooms, 9 m each, with two doors of 2 m between them.
Rows two_rooms() {
  Rows rows(48, std::string(80, '.'));
  for (std::size_t y = 0; y < rows.size(); ++y) {
    for (std::size_t x = 0; x < rows[y].size(); ++x) {
      const bool is_door = (y >= 6 && y < 14) || (y >= 34 && y < 42);
      if (y == 0 || x == 0 || y == 47 || x == 79 || (x == 40 && !is_door)) rows[y][x] = '#';
    }
  }
  return rows;
}

Rows with_box(Rows rows, Cell low, Cell high, char c) {
  for (int y = low.y; y <= high.y; ++y) {
    for (int x = low.x; x <= high.x; ++x) rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = c;
  }
  return rows;
}

class ActivePoses : public testing::Test {
 protected:
  ActivePoses() { planner_.set_zones({}); }

  void show(const Rows& rows) {
    const Grid wanted = test::sketch(rows, {}, 0.25);
    wanted.cells().for_each_brick([&](BrickIndex index, const Brick& brick) { planner_.set_brick(index, brick); });
    planner_.project();
    ++revision_;
    utime_ += kSecond;
  }
  [[nodiscard]] Planner::Moment now() const { return {revision_, utime_}; }
  static PathRequest across(const std::string& id) {
    PathRequest request;
    request.id = id;
    request.robot = "robot1";
    request.start = Eigen::Vector2d(3, 2.5);
    request.goal = {16, 2.5};
    request.goal_yaw = M_PI / 2;
    request.keep_active = true;
    return request;
  }
  static Robot fork_lift(double length = 1.2, double width = 0.8, double turn_radius = 0.4) {
    return {0, 0.5, Body{*make_rectangle(length, width), turn_radius}, {}};
  }
  /// Runs what is to be searched until nothing is.
  void search() {
    while (const auto quest = planner_.next_quest()) quest->run();
  }
  Path ask(const PathRequest& request, const Robot& robot) {
    planner_.serve(now());
    if (const auto reply = planner_.request(request, robot, now()); reply.path) return *reply.path;
    for (int i = 0; i < 10; ++i) {
      search();
      for (const Planner::Reply& reply : planner_.serve(now())) {
        if (reply.path && reply.path->id == request.id) return *reply.path;
      }
    }
    ADD_FAILURE() << "no answer";
    return {};
  }
  std::vector<Path> replan() {
    planner_.serve(now());
    return planner_.replan(now());
  }

  /// By the validator, on a grid of the test's own.
  bool is_valid(const Path& path) const {
    OpenGrid open(80, 48);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 80; ++x) {
        open.set({x, y}, is_free(planner_.grid().at({x, y})) && planner_.zones().no_go_at({x, y}) == nullptr);
      }
    }
    const auto footprint = Footprint::make(path.footprint);
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < path.points.size(); ++i) {
      poses.push_back({path.points[i].head<2>(), path.details[i].yaw});
    }
    if (poses.empty() || !footprint) return false;
    const auto fault = fault_of({open, 0.25, *footprint, path.turn_radius, poses.front(), poses.back()}, poses);
    EXPECT_FALSE(fault) << *fault;
    return !fault;
  }

  Planner planner_{Grid(0.25, make_band(0, 0.25, 0.25).value(), 0.5)};
  std::int64_t revision_ = 0;
  std::int64_t utime_ = 1'700'000'000'000'000;
};

TEST_F(ActivePoses, AFootprintGetsAPathOfPoses) {
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

TEST_F(ActivePoses, AChangeBesideThePathLeavesItOneOnItEndsItAtOnceAndThenThereIsAnother) {
  show(two_rooms());
  const Path first = ask(across("p1"), fork_lift());
  ASSERT_EQ(first.status, "OK");
  show(with_box(two_rooms(), {20, 30}, {24, 34}, '#'));
  EXPECT_TRUE(replan().empty());

  show(with_box(two_rooms(), {40, 6}, {40, 13}, '#'));
  std::vector<Path> said = replan();
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].status, "REPLANNING");
  EXPECT_TRUE(said[0].active);
  EXPECT_TRUE(said[0].points.empty());
  EXPECT_EQ(said[0].superseded, first.path_id);
  EXPECT_TRUE(replan().empty()) << "nothing new until it is found";
  search();
  said = replan();
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].status, "OK") << said[0].message;
  EXPECT_GT(said[0].length, first.length + 5);
  EXPECT_EQ(said[0].map_revision, revision_);
  EXPECT_TRUE(is_valid(said[0]));

  show(with_box(with_box(two_rooms(), {40, 6}, {40, 13}, '#'), {40, 34}, {40, 41}, '#'));
  ASSERT_EQ(replan().front().status, "REPLANNING");
  search();
  said = replan();
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].status, "NO_VALID_PATH");
  EXPECT_TRUE(said[0].nearest.has_value());
  show(two_rooms());
  utime_ += kSecond;
  (void)replan();
  search();
  EXPECT_EQ(replan().front().status, "OK");
}

TEST_F(ActivePoses, WhatChangesWhileItIsLookedForIsHeeded) {
  show(two_rooms());
  planner_.serve(now());
  ASSERT_FALSE(planner_.request(across("p1"), fork_lift(), now()).path);
  const auto quest = planner_.next_quest();
  ASSERT_NE(quest, nullptr);
  EXPECT_EQ(planner_.next_quest(), nullptr) << "one at a time";
  quest->run();
  show(with_box(two_rooms(), {40, 6}, {40, 13}, '#'));  // what was found leads through there
  EXPECT_TRUE(planner_.serve(now()).empty());
  search();
  const auto replies = planner_.serve(now());
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0].path->status, "OK") << replies[0].path->message;
  EXPECT_EQ(replies[0].path->map_revision, revision_);
  EXPECT_TRUE(is_valid(*replies[0].path));
}

TEST_F(ActivePoses, AWayThatOpensWhileItIsLookedForIsFound) {
  const Rows closed = with_box(with_box(two_rooms(), {40, 6}, {40, 13}, '#'), {40, 34}, {40, 41}, '#');
  show(closed);
  planner_.serve(now());
  ASSERT_FALSE(planner_.request(across("p1"), fork_lift(), now()).path);
  const auto quest = planner_.next_quest();
  ASSERT_NE(quest, nullptr);
  quest->run();
  ASSERT_EQ(quest->legs().back().outcome, PoseOutcome::kNoWay);
  show(two_rooms());
  EXPECT_TRUE(planner_.serve(now()).empty()) << "that there is none is not said of a map on which there is one";
  search();
  const auto replies = planner_.serve(now());
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0].path->status, "OK") << replies[0].path->message;
  EXPECT_TRUE(is_valid(*replies[0].path));
}

TEST_F(ActivePoses, ARobotThatStandsStillGoesFirstButNotAlways) {
  show(two_rooms());
  const auto of = [&](const std::string& robot) {
    PathRequest request = across(robot + "'s");
    request.robot = robot;
    return request;
  };
  ASSERT_EQ(ask(of("kept1"), fork_lift()).status, "OK");
  ASSERT_EQ(ask(of("kept2"), fork_lift()).status, "OK");
  planner_.serve(now());
  for (const char* robot : {"new1", "new2"}) {
    PathRequest request = of(robot);
    request.start->y() = robot == std::string("new1") ? 3.1 : 3.2;
    ASSERT_FALSE(planner_.request(request, fork_lift(), now()).path);
  }
  show(with_box(two_rooms(), {40, 6}, {40, 13}, '#'));
  ASSERT_EQ(replan().size(), 2U);
  std::vector<double> order;
  while (const auto quest = planner_.next_quest()) {
    order.push_back(quest->places().front().p.y());
    quest->run();
  }
  EXPECT_EQ(order, (std::vector<double>{2.5, 3.1, 2.5, 3.2}));
}

TEST_F(ActivePoses, ZonesThatCostLeadThroughTheOtherDoorAlsoWhenTheyComeLater) {
  show(two_rooms());
  const auto highest = [](const Path& path) {
    double most = 0;
    for (const Eigen::Vector3d& p : path.points) most = std::max(most, p.y());
    return most;
  };
  const Path first = ask(across("p1"), fork_lift());
  ASSERT_EQ(first.status, "OK");
  EXPECT_LT(highest(first), 5);
  planner_.set_zones(std::vector<Zone>{test::costly("beside", {1, 8}, {4, 11}, 15)});
  EXPECT_TRUE(replan().empty()) << "not on its way";
  planner_.set_zones(std::vector<Zone>{test::costly("wet floor", {8, 0}, {12, 6}, 15)});
  std::vector<Path> said = replan();
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].status, "REPLANNING");
  search();
  said = replan();
  ASSERT_EQ(said.size(), 1U);
  ASSERT_EQ(said[0].status, "OK") << said[0].message;
  EXPECT_GT(highest(said[0]), 8.5) << "by the other door";
  EXPECT_TRUE(is_valid(said[0]));
  // A corridor forces another robot through the lower door.
  planner_.set_zones(std::vector<Zone>{test::corridor("a", {1, 0}, {6, 11}), test::corridor("b", {1, 8.6}, {18, 11}),
                                       test::corridor("c", {14, 0}, {18, 11})});
  PathRequest request = across("p2");
  request.robot = "robot2";
  const Path forced = ask(request, fork_lift());
  ASSERT_EQ(forced.status, "OK") << forced.message;
  EXPECT_GT(highest(forced), 8.5);
  // Where all is dear the path is found, and stays.
  planner_.set_zones(std::vector<Zone>{test::costly("all", {0, 0}, {20, 12}, 15)});
  (void)replan();
  search();
  (void)replan();
  utime_ += kSecond;
  EXPECT_TRUE(replan().empty());
  EXPECT_EQ(planner_.next_quest(), nullptr) << "nothing is looked for again and again";
  for (const Path& path : planner_.kept()) EXPECT_EQ(path.status, "OK");
}

TEST_F(ActivePoses, CancelEndsASearchThatIsUnderWayAndOneThatWaits) {
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

TEST_F(ActivePoses, OthersNeedNotWaitForASearch) {
  show(two_rooms());
  planner_.serve(now());
  ASSERT_FALSE(planner_.request(across("p1"), fork_lift(), now()).path);
  PathRequest round = across("p2");
  round.robot = "robot2";
  const auto reply = planner_.request(round, {0.3}, now());
  ASSERT_TRUE(reply.path);
  EXPECT_EQ(reply.path->status, "OK");
}

TEST_F(ActivePoses, OtherRobotsStandInTheWayAndTheRobotItselfDoesNot) {
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

TEST_F(ActivePoses, ByWayOfWaypointsAndTheOneThatFailsIsNamed) {
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

TEST_F(ActivePoses, WhatCannotBeIsSaidClearly) {
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

TEST_F(ActivePoses, AZoneThatCutsTheWayOffIsNamed) {
  show(two_rooms());
  const std::vector<Zone> zones{test::no_go("upper", {9.5, 1.6}, {10.5, 3.4}),
                                test::no_go("lower", {9.5, 8.6}, {10.5, 10.4})};
  planner_.set_zones(zones);
  const Path path = ask(across("p1"), fork_lift());
  EXPECT_EQ(path.status, "NO_VALID_PATH");
  EXPECT_NE(path.message.find("'upper'"), std::string::npos) << path.message;
}

TEST_F(ActivePoses, EveryPathThatIsSaidIsValidOnTheMapThatItNames) {
  int found = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Rows rows = two_rooms();
    show(rows);
    (void)ask(across("p" + std::to_string(seed)), fork_lift(1.2, 0.8, seed % 2 == 0 ? 0.4 : 0));
    for (int step = 0; step < 25; ++step) {
      // Every other change comes where the path leads; what it closes is opened again some time.
      const Path kept = planner_.kept().front();
      Cell low{static_cast<int>(random() % 60) + 1, static_cast<int>(random() % 30) + 1};
      const bool closes = step % 2 == 0 && !kept.points.empty();
      if (closes) {
        const Eigen::Vector3d& p = kept.points[random() % kept.points.size()];
        low = {std::min(static_cast<int>(p.x() / 0.25), 75), std::min(static_cast<int>(p.y() / 0.25), 43)};
      }
      const int size = closes ? 2 : 17;
      rows = with_box(rows, low, {low.x + size, low.y + size}, closes ? '#' : '.');
      show(rows);
      // A search may be under way or done while the map goes on to change.
      if (random() % 3 != 0) search();
      for (const Path& path : replan()) {
        EXPECT_EQ(path.map_revision, revision_);
        if (path.status != "OK") continue;
        ++found;
        ASSERT_TRUE(is_valid(path));
      }
      for (const Path& path : planner_.kept()) {
        ASSERT_TRUE(path.status != "OK" || is_valid(path)) << "what is kept holds, too";
      }
    }
  }
  EXPECT_GE(found, 8);
}

}  // namespace
}  // namespace concord
