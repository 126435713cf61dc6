#include "planner/robot_layer.hpp"

#include <gtest/gtest.h>

#include "planner/planner.hpp"
#include "sketch.hpp"
#include "zones.hpp"

namespace concord {
namespace {

using Rows = std::vector<std::string>;

TEST(RobotLayer, HoldsEveryCellOfTheDiscAndMovesWhenTheRobotDoes) {
  std::mt19937 random(1);
  RobotLayer layer;
  Eigen::Vector2d p(10, 10);
  for (int i = 0; i < 200; ++i) {
    p += Eigen::Vector2d(0.01 * static_cast<double>(random() % 100), 0.01 * static_cast<double>(random() % 100)) -
         Eigen::Vector2d(0.5, 0.5);
    layer.set("robot1", p, 2.5);
    for (std::int32_t y = -30; y < 50; ++y) {
      for (std::int32_t x = -30; x < 50; ++x) {
        const bool stands = (layer.at({x >> 3, y >> 3, 0}) >> ((x & 7) | (y & 7) << 3) & 1) != 0;
        const double gap = test::distance(p.x(), p.y(), {x, y});
        ASSERT_TRUE(stands || gap >= 2.5) << x << ' ' << y;
        ASSERT_TRUE(!stands || gap <= 2.5 + 2 * 1.0) << x << ' ' << y;
      }
    }
  }
  EXPECT_TRUE(layer.set("robot1", p, 2.5).empty());
  EXPECT_FALSE(layer.leave_out("robot1").empty());
  EXPECT_EQ(layer.at({static_cast<std::int32_t>(std::floor(p.x())) >> 3,
                      static_cast<std::int32_t>(std::floor(p.y())) >> 3, 0}),
            0U);
  EXPECT_FALSE(layer.leave_out("").empty());
  layer.remove("robot1");
  EXPECT_TRUE(layer.empty());
}

class RobotsOnTheGrid : public testing::Test {
 protected:
  RobotsOnTheGrid() { planner_.set_zones({}); }
  void show(const Rows& rows) {
    test::sketch(rows).cells().for_each_brick(
        [&](BrickIndex index, const Brick& brick) { planner_.set_brick(index, brick); });
    planner_.project();
  }
  Path ask(const std::string& robot, Eigen::Vector2d goal, bool keep = true) {
    PathRequest request;
    request.id = "p" + std::to_string(++asked_);
    request.robot = robot;
    request.goal = goal;
    request.keep_active = keep;
    planner_.serve(now());
    return planner_.request(request, {0.4}, now()).path.value();
  }
  Planner::Moment now() { return {1, utime_ += 1'000'000}; }
  std::vector<Path> replan() {
    planner_.serve(now());
    return planner_.replan(now());
  }

  Planner planner_{Grid(1.0, make_band(0, 1, 1.0).value(), 0.5)};
  int asked_ = 0;
  std::int64_t utime_ = 1'700'000'000'000'000;
};

const Rows kCorridor(5, std::string(60, '.'));

TEST_F(RobotsOnTheGrid, StandInEachOthersWayNeverInTheirOwn) {
  show(kCorridor);
  planner_.set_pose("robot1", {4.5, 2.5}, 0.4);
  planner_.set_pose("robot2", {40.5, 2.5}, 0.4);
  const Path past = ask("robot1", {30.5, 2.5});
  EXPECT_EQ(past.status, "OK") << past.message;
  const Path into = ask("robot1", {40.5, 2.5}, false);
  EXPECT_EQ(into.status, "GOAL_CLEARANCE");
  EXPECT_NE(into.message.find("robot2"), std::string::npos) << into.message;
  planner_.set_pose("robot3", {20.5, 2.5}, 2.4);  // as wide as the corridor
  std::vector<Path> paths = replan();
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].status, "NO_VALID_PATH");
  EXPECT_NE(paths[0].message.find("robot3"), std::string::npos) << paths[0].message;
  ASSERT_TRUE(paths[0].nearest);
  EXPECT_GT(paths[0].nearest->x(), 12);
  EXPECT_LT(paths[0].nearest->x(), 20);
  EXPECT_EQ(ask("robot3", {50.5, 2.5}, false).status, "OK") << "not in its own";
  planner_.keep_poses({"robot1", "robot2"});
  paths = replan();
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].status, "OK");
}

TEST_F(RobotsOnTheGrid, OwnMovesChangeNothing) {
  show(kCorridor);
  planner_.set_pose("robot1", {4.5, 2.5}, 0.4);
  ask("robot1", {50.5, 2.5});
  for (double x = 4.5; x < 50; x += 1.7) {
    planner_.set_pose("robot1", {x, 2.5}, 0.4);
    EXPECT_TRUE(replan().empty());
  }
}

TEST_F(RobotsOnTheGrid, EveryPointOfAPathIsDescribed) {
  show(kCorridor);
  planner_.set_zones(std::vector{test::no_go("press", {20.2, 4.2}, {21.8, 4.8})});
  planner_.set_pose("robot1", {4.5, 2.5}, 0.4);
  PathRequest request;
  request.id = "w";
  request.robot = "robot1";
  request.waypoints = {{30.5, 1.5}, {40.5, 3.5}};
  request.goal = {50.5, 2.5};
  const Path path = planner_.request(request, {0.4, 2.0}, now()).path.value();
  ASSERT_EQ(path.status, "OK") << path.message;
  ASSERT_EQ(path.details.size(), path.points.size());
  double along = 0;
  double least = 1e9;
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    if (i > 0) along += (path.points[i] - path.points[i - 1]).norm();
    EXPECT_NEAR(path.details[i].eta, along / 2.0, 1e-9);
    least = std::min(least, path.details[i].clearance);
  }
  EXPECT_GE(least, path.least_clearance - 1e-9);
  EXPECT_EQ(path.details.back().leg, 2);
  EXPECT_EQ(path.zones, std::vector<std::string>{"press"});
  EXPECT_EQ(path.failed_leg, -1);
  EXPECT_GT(path.path_id, 0);
}

TEST_F(RobotsOnTheGrid, CancellingEndsWhatIsKeptAndWhatWaits) {
  show(kCorridor);
  planner_.set_pose("robot1", {4.5, 2.5}, 0.4);
  const Path kept = ask("robot1", {50.5, 2.5});
  const auto ended = planner_.cancel("robot1", now());
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_EQ(ended[0].path.status, "CANCELLED");
  EXPECT_EQ(ended[0].path.id, kept.id);
  EXPECT_EQ(ended[0].path.superseded, kept.path_id);
  EXPECT_FALSE(ended[0].path.active);
  EXPECT_TRUE(ended[0].path.points.empty());
  EXPECT_EQ(planner_.active_count(), 0U);
  EXPECT_TRUE(planner_.cancel("robot1", now()).empty());
}

TEST_F(RobotsOnTheGrid, ARobotInANoGoZoneMayLeaveItAndNoMore) {
  show(Rows(20, std::string(60, '.')));
  planner_.set_zones(std::vector{test::no_go("press", {2.2, 2.2}, {12.8, 12.8})});
  planner_.set_pose("robot1", {6.5, 8.5}, 0.4);
  const Path out = ask("robot1", {40.5, 8.5});
  ASSERT_EQ(out.status, "OK") << out.message;
  // The way out is the shortest, and from there on the zone is as forbidden as ever.
  std::size_t outside = 0;
  while (planner_.zones().no_go_at(cell_of(out.points[outside].head<2>())) != nullptr) ++outside;
  EXPECT_LT((out.points[outside] - out.points[0]).norm(), 8.0);
  for (std::size_t i = outside; i < out.points.size(); ++i) {
    EXPECT_EQ(planner_.zones().no_go_at(cell_of(out.points[i].head<2>())), nullptr);
  }
  EXPECT_EQ(ask("robot1", {8.5, 8.5}, false).status, "GOAL_IN_NO_GO");
}

TEST_F(RobotsOnTheGrid, EachHeightHasAGridOfItsOwn) {
  Planner planner(Grid(1.0, make_band(0, 2, 1.0).value(), 0.5));
  planner.set_zones({});
  DenseBrick dense;
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      for (int z = 0; z < 8; ++z) dense[local_of(VoxelIndex{x, y, z})] = x == 4 && z == 1 ? kOccupied : kFree;
    }
  }
  planner.set_brick({0, 0, 0}, Brick::from_dense(dense));  // a beam at 1 to 2 m across it all
  planner.project();
  PathRequest request;
  request.robot = "robot1";
  request.start = Eigen::Vector2d(1.5, 4.5);
  request.goal = {6.5, 4.5};
  const auto status = [&](const std::string& id, std::pair<double, double> band) {
    request.id = id;
    planner.serve(now());
    return planner.request(request, {0.3, 0.5, {}, band}, now()).path.value().status;
  };
  EXPECT_EQ(status("tall", {0, 2}), "NO_VALID_PATH");
  EXPECT_EQ(status("low", {0, 1}), "OK");
  EXPECT_EQ(status("flying", {3, 5}), "OK");
  EXPECT_EQ(status("none", {3, 3.2}), "BAD_REQUEST");
}

TEST_F(RobotsOnTheGrid, WhatAnEditClosesIsBlamedOnIt) {
  show(kCorridor);
  const auto close = [&](int x) {
    DenseBrick dense;
    test::sketch(kCorridor).cells().find(brick_of(VoxelIndex{x, 0, 0}))->to_dense(dense);
    for (int y = 0; y < 5; ++y) dense[local_of(VoxelIndex{x, y, 0})] = kPinnedOccupied;
    planner_.set_brick(brick_of(VoxelIndex{x, 0, 0}), Brick::from_dense(dense));
    planner_.project();
  };
  close(20);
  planner_.set_pose("robot1", {4.5, 2.5}, 0.4);
  const Path path = ask("robot1", {50.5, 2.5});
  EXPECT_EQ(path.status, "BLOCKED_BY_EDIT") << path.message;
  const auto cut = planner_.cut_of("robot1", path.path_id);
  ASSERT_TRUE(cut);
  EXPECT_NEAR(cut->p.x(), 20.5, 1.5);
  EXPECT_FALSE(planner_.cut_of("robot1", path.path_id)) << "it is asked about once";
  const auto named = planner_.name_edit("robot1", path.path_id, "e-1", "anna");
  ASSERT_TRUE(named);
  EXPECT_EQ(named->edit_id, "e-1");
  EXPECT_NE(path.message.find("an edit cuts the goal off"), std::string::npos) << path.message;
  EXPECT_TRUE(replan().empty());
  close(36);
  const Path twice = ask("robot1", {50.5, 2.5});
  EXPECT_EQ(twice.status, "BLOCKED_BY_EDIT");
  EXPECT_NE(twice.message.find("edits in 2 places"), std::string::npos)
      << "one of them alone opens nothing: " << twice.message;
}

}  // namespace
}  // namespace concord
