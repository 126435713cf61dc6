#include "agent/sim/path_follower.hpp"

#include <gtest/gtest.h>

namespace concord {
namespace {

constexpr std::int64_t kSecond = 1'000'000;

Path path_of(std::int64_t path_id, std::vector<Eigen::Vector3d> points) {
  Path path;
  path.id = "r-1";
  path.robot = "robot1";
  path.status = "OK";
  path.active = true;
  path.path_id = path_id;
  path.points = std::move(points);
  return path;
}

const Path kRoundTheCorner = path_of(1, {{0, 0, 0}, {4, 0, 0}, {4, 3, 0}});
constexpr double kFree = 100;

TEST(PathFollower, GoesAlongItsPathToTheGoal) {
  PathFollower robot({{0, 0}, 1}, 0.5);
  EXPECT_FALSE(robot.go(1, kFree, 0)) << "nobody has sent it anywhere";
  robot.hear(kRoundTheCorner, 0);
  double before = 0;
  for (int i = 1; i <= 14; ++i) {
    robot.hear(kRoundTheCorner, i * kSecond);  // said each second
    EXPECT_TRUE(robot.go(1, kFree, i * kSecond));
    EXPECT_NEAR(robot.driven() - before, 0.5, 1e-9);
    before = robot.driven();
  }
  EXPECT_FALSE(robot.go(1, kFree, 14 * kSecond));
  EXPECT_LT((robot.place().p - Eigen::Vector2d(4, 3)).norm(), 1e-9);
  EXPECT_NEAR(robot.place().yaw, M_PI / 2, 1e-9);
  EXPECT_EQ(robot.stops(), 0) << "it is there";
}

TEST(PathFollower, AnotherPathTurnsItAsideFromWhereItIs) {
  PathFollower robot({{0, 0}, 0}, 1);
  robot.hear(kRoundTheCorner, 0);
  ASSERT_TRUE(robot.go(2, kFree, 0));
  robot.hear(path_of(2, {{1.5, 0, 0}, {2, 0, 0}, {2, 5, 0}}), kSecond);
  ASSERT_TRUE(robot.go(1, kFree, kSecond));
  EXPECT_LT((robot.place().p - Eigen::Vector2d(2, 1)).norm(), 1e-9);
  EXPECT_EQ(robot.stops(), 0);
}

TEST(PathFollower, WithAFootprintItPointsWhereThePathSays) {
  PathFollower robot({{0, 0}, 3.0}, 1);
  Path back = path_of(1, {{0, 0, 0}, {-2, 0, 0}, {-2, 0, 0}});
  back.footprint = {{0.6, 0.4}, {-0.6, 0.4}, {-0.6, -0.4}, {0.6, -0.4}};
  back.details.resize(3);
  back.details[0].yaw = 3.0;
  back.details[1].yaw = -3.0;
  back.details[2].yaw = 1.0;
  robot.hear(back, 0);
  ASSERT_TRUE(robot.go(1, kFree, 0));
  EXPECT_NEAR(std::remainder(robot.place().yaw - M_PI, 2 * M_PI), 0, 1e-9) << "half way, the shorter way round";
  EXPECT_NEAR(std::abs(robot.heading()), M_PI, 1e-9);
  ASSERT_TRUE(robot.go(1, kFree, 0));
  EXPECT_NEAR(robot.place().yaw, 1.0, 1e-9);
}

TEST(PathFollower, APathThatIsFarAwayStopsItOnce) {
  PathFollower robot({{0, 0}, 0}, 1);
  for (int i = 0; i < 3; ++i) robot.hear(path_of(2, {{0, 5, 0}, {4, 5, 0}}), i * kSecond);
  EXPECT_EQ(robot.stops(), 0) << "it was on none";
  robot.hear(kRoundTheCorner, 3 * kSecond);
  for (int i = 4; i < 7; ++i) robot.hear(path_of(2, {{0, 5, 0}, {4, 5, 0}}), i * kSecond);
  EXPECT_EQ(robot.stops(), 1);
}

TEST(PathFollower, WhatTheValidatorRefusesStopsIt) {
  for (const char* status : {"VALIDATION_FAILED", "REPLANNING", "NO_VALID_PATH", "MAP_STALE"}) {
    PathFollower robot({{0, 0}, 0}, 1);
    robot.hear(kRoundTheCorner, 0);
    ASSERT_TRUE(robot.go(1, kFree, 0));
    Path refused = path_of(2, {});
    refused.status = status;
    robot.hear(refused, 0);
    EXPECT_FALSE(robot.go(1, kFree, 0)) << status;
    EXPECT_EQ(robot.stops(), 1);
    EXPECT_LT((robot.place().p - Eigen::Vector2d(1, 0)).norm(), 1e-9);
  }
}

TEST(PathFollower, StopsWhenItsPathEndsOrNobodySpeaksOfItAnyMore) {
  PathFollower robot({{0, 0}, 0}, 0.1);
  robot.hear(kRoundTheCorner, 0);
  EXPECT_TRUE(robot.go(1, kFree, 3 * kSecond));
  EXPECT_FALSE(robot.go(1, kFree, 3 * kSecond + 1));
  robot.hear(kRoundTheCorner, 4 * kSecond);
  EXPECT_TRUE(robot.go(1, kFree, 4 * kSecond)) << "and goes on when it is said again";
  Path ended = kRoundTheCorner;
  ended.active = false;
  ended.id = "another";
  robot.hear(ended, 4 * kSecond);
  EXPECT_TRUE(robot.go(1, kFree, 4 * kSecond)) << "an answer to a question";
  ended.id = "r-1";
  robot.hear(ended, 4 * kSecond);
  EXPECT_FALSE(robot.go(1, kFree, 4 * kSecond));
}

TEST(PathFollower, DoesNotTakeAPathThatIsNotItsToFollow) {
  PathFollower robot({{0, 5}, 0}, 1);
  robot.hear(kRoundTheCorner, 0);
  EXPECT_FALSE(robot.go(1, kFree, 0)) << "it is metres away";
  PathFollower other({{0, 0}, 0}, 1);
  Path turned = kRoundTheCorner;
  turned.frame_agent = "headset1";
  other.hear(turned, 0);
  EXPECT_FALSE(other.go(1, kFree, 0)) << "in another frame";
}

TEST(PathFollower, StandsBeforeWhatItsBumperTouches) {
  PathFollower robot({{0, 0}, 0}, 1);
  robot.hear(kRoundTheCorner, 0);
  EXPECT_TRUE(robot.go(1, 0.2, 0));
  EXPECT_NEAR(robot.place().p.x(), 0.2, 1e-9);
  EXPECT_FALSE(robot.go(1, -0.1, 0));
  EXPECT_EQ(robot.heading(), 0);
}

}  // namespace
}  // namespace concord
