// What becomes of kept paths of robots that are not round.
#include <random>

#include "active_poses.hpp"

namespace concord {
namespace {

using test::ActivePoses;
using test::kSecond;
using test::Rows;
using test::two_rooms;
using test::with_box;

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
