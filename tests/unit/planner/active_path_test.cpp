#include <gtest/gtest.h>

#include "planner/clearance.hpp"
#include "planner/planner.hpp"
#include "sketch.hpp"

namespace concord {
namespace {

using Rows = std::vector<std::string>;
constexpr std::int64_t kSecond = 1'000'000;

const Rows kTwoDoors{
    "############",  //
    "#....#.....#",  //
    "#..........#",  // door
    "#....#.....#",  //
    "#....#.....#",  //
    "#....#.....#",  //
    "#....#.....#",  //
    "#..........#",  // door
    "#....#.....#",  //
    "############",
};

Rows with(Rows rows, const std::vector<Cell>& cells, char c) {
  for (const Cell cell : cells) rows[cell.y][cell.x] = c;
  return rows;
}
const Rows kUpperShut = with(kTwoDoors, {{5, 2}}, '#');
const Rows kBothShut = with(kUpperShut, {{5, 7}}, '#');

PathRequest from_to(const std::string& id, const std::string& robot, std::optional<Eigen::Vector2d> start,
                    Eigen::Vector2d goal) {
  PathRequest request;
  request.id = id;
  request.robot = robot;
  request.start = start;
  request.goal = goal;
  request.keep_active = true;
  return request;
}

const PathRequest kAcross = from_to("p1", "robot1", Eigen::Vector2d(2.5, 2.5), {8.5, 2.5});

class ActivePath : public testing::Test {
 protected:
  ActivePath() { planner_.set_zones({}); }
  /// The map becomes this.
  void show(const Rows& rows) {
    const Grid wanted = test::sketch(rows);
    for (const BrickIndex index : planner_.grid().cells().sorted_bricks()) {
      if (wanted.cells().find(index) == nullptr) planner_.set_brick(index, {});
    }
    wanted.cells().for_each_brick([&](BrickIndex index, const Brick& brick) { planner_.set_brick(index, brick); });
    planner_.project();
    ++revision_;
    utime_ += kSecond;
  }
  [[nodiscard]] Planner::Moment now() const { return {revision_, utime_}; }
  Path ask(const PathRequest& request) {
    planner_.serve(now());
    return planner_.request(request, {0.4}, now()).path.value();
  }
  std::vector<Path> replan() {
    planner_.serve(now());
    return planner_.replan(now());
  }

  bool is_safe(const Path& path) {
    std::vector<Eigen::Vector2d> points;
    for (const Eigen::Vector3d& p : path.points) points.push_back(p.head<2>());
    return is_clear(planner_.grid(), points, 0.4);
  }

  Planner planner_{Grid(1.0, make_band(0, 1, 1.0).value(), 0.5)};
  std::int64_t revision_ = 0;
  std::int64_t utime_ = 1'700'000'000'000'000;
};

TEST_F(ActivePath, IsReplannedWhenTheMapBlocksIt) {
  show(kTwoDoors);
  const Path first = ask(kAcross);
  ASSERT_EQ(first.status, "OK");
  EXPECT_TRUE(first.active);
  EXPECT_EQ(first.plan_number, 0);
  EXPECT_NEAR(first.length, 6, 1e-9);
  EXPECT_EQ(first.points.front().z(), 0.0);

  show(kUpperShut);
  const std::vector<Path> second = replan();
  ASSERT_EQ(second.size(), 1U);
  EXPECT_EQ(second[0].status, "OK");
  EXPECT_EQ(second[0].id, "p1");
  EXPECT_EQ(second[0].plan_number, 1);
  EXPECT_EQ(second[0].map_revision, revision_);
  EXPECT_GT(second[0].length, 10);
  EXPECT_TRUE(is_safe(second[0]));

  show(kBothShut);
  const std::vector<Path> third = replan();
  ASSERT_EQ(third.size(), 1U);
  EXPECT_EQ(third[0].status, "NO_VALID_PATH");
  EXPECT_TRUE(third[0].points.empty());
  EXPECT_EQ(third[0].plan_number, 2);

  show(kTwoDoors);
  const std::vector<Path> fourth = replan();
  ASSERT_EQ(fourth.size(), 1U);
  EXPECT_EQ(fourth[0].status, "OK");
  EXPECT_NEAR(fourth[0].length, 6, 1e-9);
  EXPECT_EQ(fourth[0].plan_number, 3);
}

TEST_F(ActivePath, StaysWhenTheChangeDoesNotTouchItAndSavesLittle) {
  show(kTwoDoors);
  ask(kAcross);
  show(with(kTwoDoors, {{9, 7}}, '#'));
  EXPECT_TRUE(replan().empty());
  show(kTwoDoors);
  EXPECT_TRUE(replan().empty());
  EXPECT_EQ(ask(kAcross).plan_number, 0);
}

TEST_F(ActivePath, IsReplannedWhenAMuchShorterWayOpens) {
  show(kUpperShut);
  EXPECT_GT(ask(kAcross).length, 10);
  show(kTwoDoors);
  const std::vector<Path> paths = replan();
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_NEAR(paths[0].length, 6, 1e-9);
  EXPECT_TRUE(replan().empty());
}

TEST_F(ActivePath, IsReplannedWhenItsGroundIsNoLongerKnown) {
  show(kTwoDoors);
  ask(kAcross);
  show(with(kTwoDoors, {{5, 2}}, ' '));
  const std::vector<Path> paths = replan();
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_GT(paths[0].length, 10);
}

TEST_F(ActivePath, AFailureThatBecomesAnotherIsSaid) {
  show(kTwoDoors);
  ask(kAcross);
  show(with(kTwoDoors, {{8, 2}}, ' '));
  std::vector<Path> paths = replan();
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].status, "GOAL_UNKNOWN");
  show(with(kTwoDoors, {{8, 2}}, '#'));
  paths = replan();
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].status, "GOAL_OCCUPIED");
  show(with(kTwoDoors, {{8, 2}, {9, 5}}, '#'));
  EXPECT_TRUE(replan().empty());  // still the same
}

TEST_F(ActivePath, StartsWhereTheRobotIs) {
  show(kTwoDoors);
  const PathRequest request = from_to("p1", "robot1", std::nullopt, {8.5, 2.5});
  EXPECT_EQ(ask(request).status, "NO_POSE");
  EXPECT_TRUE(replan().empty());
  planner_.set_pose("robot1", {2.5, 2.5});
  std::vector<Path> paths = replan();
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].status, "OK");
  EXPECT_EQ(paths[0].points.front().head<2>(), Eigen::Vector2d(2.5, 2.5));

  planner_.set_pose("robot1", {3.5, 2.5});
  EXPECT_TRUE(replan().empty());  // it follows its path
  show(kUpperShut);
  paths = replan();
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].points.front().head<2>(), Eigen::Vector2d(3.5, 2.5));
}

TEST_F(ActivePath, TheSameRequestTwiceIsDoneOnce) {
  show(kTwoDoors);
  PathRequest once = kAcross;
  once.keep_active = false;
  const Path first = ask(once);
  show(kBothShut);
  const Path again = ask(once);
  EXPECT_EQ(again.status, "OK");
  EXPECT_EQ(again.points, first.points);
  EXPECT_EQ(again.map_revision, first.map_revision);
  once.robot = "robot2";  // another robot's request of that name is another request
  EXPECT_EQ(ask(once).status, "NO_VALID_PATH");
}

TEST_F(ActivePath, OnlyARequestThatIsKeptTakesItsPlace) {
  show(kTwoDoors);
  ask(kAcross);
  PathRequest question = from_to("q1", "robot1", Eigen::Vector2d(2.5, 2.5), {2.5, 7.5});
  question.keep_active = false;
  const Planner::Reply aside = planner_.request(question, {0.4}, now());
  EXPECT_FALSE(aside.path->active);
  EXPECT_FALSE(aside.ended);
  PathRequest bad = from_to("q2", "robot1", Eigen::Vector2d(2.5, 2.5), {2.5, 7.5});
  bad.radius = 1e9;
  EXPECT_EQ(ask(bad).status, "BAD_REQUEST");
  show(kUpperShut);
  const std::vector<Path> paths = replan();
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].id, "p1");

  const Planner::Reply next =
      planner_.request(from_to("p2", "robot1", Eigen::Vector2d(2.5, 2.5), {2.5, 7.5}), {0.4}, now());
  EXPECT_TRUE(next.path->active);
  ASSERT_TRUE(next.ended);
  EXPECT_EQ(next.ended->id, "p1");
  EXPECT_EQ(next.ended->points, paths[0].points);
  EXPECT_EQ(next.ended->plan_number, 1);
  EXPECT_FALSE(next.ended->active);
  EXPECT_EQ(planner_.active_count(), 1U);
  const Path old = ask(kAcross);  // an old request that comes again is told the last word
  EXPECT_FALSE(old.active);
  EXPECT_EQ(old.plan_number, 1);
}

TEST_F(ActivePath, IsSaidOnceASecond) {
  show(kTwoDoors);
  const Path first = ask(kAcross);
  utime_ += kSecond - 1;
  EXPECT_TRUE(planner_.repeat(now()).empty());
  utime_ += 1;
  ++revision_;
  planner_.set_stale(true);
  utime_ += kSecond;
  const std::vector<Path> stale = planner_.repeat(now());
  ASSERT_EQ(stale.size(), 1U);
  EXPECT_EQ(stale[0].status, "OK");
  EXPECT_NE(stale[0].message.find("nothing was heard of the map"), std::string::npos) << stale[0].message;
  planner_.set_stale(false);
  utime_ += kSecond;
  const std::vector<Path> again = planner_.repeat(now());
  ASSERT_EQ(again.size(), 1U);
  EXPECT_TRUE(again[0].active);
  EXPECT_EQ(again[0].points, first.points);
  EXPECT_EQ(again[0].plan_number, 0);
  EXPECT_EQ(again[0].map_revision, revision_);
  EXPECT_TRUE(planner_.repeat(now()).empty());

  show(kUpperShut);  // it does not hold any more, and is not said to
  const std::vector<Path> before = planner_.repeat(now());
  ASSERT_EQ(before.size(), 1U);
  EXPECT_EQ(before[0].map_revision, revision_ - 1);
  utime_ += kSecond / 2;
  EXPECT_EQ(replan().size(), 1U);
  utime_ += kSecond / 2;
  EXPECT_TRUE(planner_.repeat(now()).empty());  // the new one was said meanwhile
  utime_ -= 100 * kSecond;                      // somebody sets the clock
  EXPECT_EQ(planner_.repeat(now()).size(), 1U);
}

TEST_F(ActivePath, ASearchThatFailedIsNotRepeatedWithinASecond) {
  show(kBothShut);
  EXPECT_EQ(ask(kAcross).status, "NO_VALID_PATH");
  show(kTwoDoors);
  utime_ -= kSecond / 2;
  EXPECT_TRUE(replan().empty());
  utime_ += kSecond / 2;
  EXPECT_EQ(replan().size(), 1U);
}

TEST_F(ActivePath, ASearchThatFailedIsTriedAgainWhereTheRobotMoves) {
  show(kBothShut);
  const PathRequest request = from_to("p1", "robot1", std::nullopt, {8.5, 2.5});
  planner_.set_pose("robot1", {2.5, 2.5});
  EXPECT_EQ(ask(request).status, "NO_VALID_PATH");
  utime_ += kSecond;
  planner_.set_pose("robot1", {2.9, 2.5});
  EXPECT_TRUE(replan().empty());
  planner_.set_pose("robot1", {7.5, 4.5});  // somebody carried it across
  const std::vector<Path> paths = replan();
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].status, "OK");
}

TEST_F(ActivePath, ARobotThatIsNotAlignedIsNowhere) {
  show(kTwoDoors);
  const PathRequest request = from_to("p1", "robot1", std::nullopt, {8.5, 2.5});
  planner_.set_pose("robot1", {2.5, 2.5});
  planner_.set_pose("robot2", {2.5, 2.5});
  planner_.keep_poses({"robot2", "robot3"});
  EXPECT_EQ(ask(request).status, "NO_POSE");
  planner_.keep_poses({"robot1", "robot2"});
  EXPECT_TRUE(replan().empty());
  planner_.set_pose("robot1", {2.5, 2.5});
  ASSERT_EQ(replan().size(), 1U);
}

TEST_F(ActivePath, EveryBlockedRobotGetsItsPath) {
  show(kTwoDoors);
  for (std::size_t i = 0; i < Planner::kMaxActive; ++i) {
    PathRequest request = kAcross;
    request.robot = "robot" + std::to_string(i);
    EXPECT_TRUE(ask(request).active);
  }
  PathRequest one_more = kAcross;
  one_more.robot = "late";
  const Path path = ask(one_more);
  EXPECT_EQ(path.status, "OK");
  EXPECT_FALSE(path.active);

  show(kUpperShut);
  std::size_t replanned = 0;
  for (std::vector<Path> paths = replan(); !paths.empty(); paths = replan()) {
    for (const Path& p : paths) EXPECT_TRUE(is_safe(p));
    replanned += paths.size();
  }
  EXPECT_EQ(replanned, Planner::kMaxActive);
}

TEST_F(ActivePath, PosesOfTooManyRobotsAreRefused) {
  for (std::size_t i = 0; i < Planner::kMaxPoses; ++i) {
    EXPECT_TRUE(planner_.set_pose("robot" + std::to_string(i), {0, 0}));
  }
  EXPECT_FALSE(planner_.set_pose("late", {0, 0}));
  EXPECT_TRUE(planner_.set_pose("robot7", {1, 1}));
  planner_.keep_poses({"robot7"});
  EXPECT_TRUE(planner_.set_pose("late", {0, 0}));
}

TEST_F(ActivePath, AClearedMapEndsThePath) {
  show(kTwoDoors);
  ask(kAcross);
  planner_.clear_map();
  planner_.project();
  const std::vector<Path> paths = replan();
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].status, "NO_MAP");
}

struct Field {
  int width, height;
  double occupied;
  unsigned cells;  ///< that change at a time
  Eigen::Vector2d goal;
  unsigned seeds;
};

/// In the larger field most ends are shut in somewhere, far from most of what changes.
class ChangingField : public ActivePath, public testing::WithParamInterface<Field> {};
INSTANTIATE_TEST_SUITE_P(Sizes, ChangingField,
                         testing::Values(Field{40, 30, 0.15, 5, {36.2, 25.1}, 30},
                                         Field{200, 160, 0.38, 300, {120.2, 125.1}, 6}),
                         [](const auto& field) { return std::to_string(field.param.width); });

/// While the map changes at random, the path that stands is always safe and "no path" always true.
TEST_P(ChangingField, TheAnswerIsNeverWrong) {
  const Field& field = GetParam();
  for (unsigned seed = 0; seed < field.seeds; ++seed) {
    std::mt19937 random(seed);
    Rows rows = test::strewn(random, field.width, field.height, field.occupied, 0.02);
    const Cell goal{static_cast<std::int32_t>(field.goal.x()), static_cast<std::int32_t>(field.goal.y())};
    show(with(rows, {{2, 2}, goal}, '.'));
    PathRequest request = from_to("seed" + std::to_string(seed), "robot1", Eigen::Vector2d(2.5, 2.5), field.goal);
    Path path = ask(request);
    for (int change = 0; change < 60; ++change) {
      for (unsigned i = 0; i < field.cells; ++i) {
        rows[random() % rows.size()][random() % field.width] = "#.... "[random() % 6];
      }
      show(with(rows, {{2, 2}, goal}, '.'));
      for (const Path& next : replan()) {
        EXPECT_EQ(next.plan_number, path.plan_number + 1);
        path = next;
      }
      const PlanResult fresh = plan(planner_.grid(), *request.start, request.goal, 0.4);
      ASSERT_EQ(path.status == "OK", fresh.reason == Reason::kOk) << "seed " << seed << " change " << change;
      if (path.status == "OK") {
        ASSERT_TRUE(is_safe(path)) << "seed " << seed << " change " << change;
      }
    }
  }
}

}  // namespace
}  // namespace concord
