#include "planner/se2/pose_search.hpp"

#include <algorithm>
#include <queue>

#include <gtest/gtest.h>

#include "footprints.hpp"
#include "planner/se2/pose_check.hpp"

namespace concord {
namespace {

using test::Plain;

/// A building of rooms with doors of some cells, and things in the rooms.
Plain rooms(std::mt19937& random, int width, int height, int door) {
  Plain plain = test::all_open(width, height);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int i = 0; i < 3; ++i) {
    const bool upright = below(2) == 0;
    const int at = 5 + below((upright ? width : height) - 10), length = upright ? height : width;
    const int first = below(length - door);
    for (int k = 0; k < length; ++k) {
      if (k < first || k >= first + door) upright ? plain.set(at, k, false) : plain.set(k, at, false);
    }
  }
  for (int i = below(6); i > 0; --i) {
    const int x = below(width - 3), y = below(height - 3);
    for (int k = 0; k < 9; ++k) plain.set(x + k % 3, y + k / 3, false);
  }
  return plain;
}

Pose any_pose(std::mt19937& random, const Plain& plain) {
  return {{test::uniform(random, 0, plain.width), test::uniform(random, 0, plain.height)},
          test::uniform(random, -M_PI, M_PI)};
}

/// As the validator's terms: a cell is a metre.
std::optional<std::string> fault(const OpenGrid& grid, const Footprint& footprint, double turn_radius,
                                 const std::vector<Pose>& poses) {
  return fault_of({grid, 1, footprint, turn_radius, poses.front(), poses.back()}, poses);
}

/// The largest overlap at samples of the path, by areas.
double worst_overlap(const Plain& plain, const Footprint& footprint, const std::vector<Pose>& poses) {
  double worst = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const int count = 1 + static_cast<int>(2 * (poses[i].p - poses[i - 1].p).norm());
    for (int k = 0; k <= count; ++k) {
      const Pose pose = test::between(poses[i - 1], poses[i], static_cast<double>(k) / count);
      worst = std::max(worst, test::worst_overlap(plain, footprint.polygon(), pose));
    }
  }
  return worst;
}

/// Whether a disc gets from one point to the other over points a fifth of a cell apart, somewhat smaller than it is, so
/// that none of its ways falls between them.
bool disc_gets_there(const Plain& plain, double radius, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  constexpr int kParts = 5;
  const int width = plain.width * kParts, height = plain.height * kParts;
  const double needed = radius - 0.71 / kParts;
  const auto is_free = [&](int x, int y) {
    const double px = (x + 0.5) / kParts, py = (y + 0.5) / kParts;
    const int reach = static_cast<int>(radius) + 1;
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        const int cx = x / kParts + i, cy = y / kParts + j;
        if (plain.at(cx, cy)) continue;
        const double dx = std::max({cx - px, 0.0, px - cx - 1}), dy = std::max({cy - py, 0.0, py - cy - 1});
        if (dx * dx + dy * dy < needed * needed) return false;
      }
    }
    return true;
  };
  const auto index = [&](const Eigen::Vector2d& p) {
    return static_cast<int>(p.y() * kParts) * width + static_cast<int>(p.x() * kParts);
  };
  std::vector<bool> seen(static_cast<std::size_t>(width * height));
  std::queue<int> next;
  next.push(index(from));
  seen[static_cast<std::size_t>(index(from))] = true;
  while (!next.empty()) {
    const int at = next.front();
    next.pop();
    if (at == index(to)) return true;
    for (int d = 0; d < 9; ++d) {
      const int x = at % width + d % 3 - 1, y = at / width + d / 3 - 1;
      if (x < 0 || y < 0 || x >= width || y >= height || seen[static_cast<std::size_t>(y * width + x)]) continue;
      seen[static_cast<std::size_t>(y * width + x)] = true;
      if (is_free(x, y)) next.push(y * width + x);
    }
  }
  return false;
}

PoseEffort little() {
  PoseEffort effort;
  effort.guided = 400;
  effort.corridor = 200;
  effort.anywhere = 200;
  return effort;
}

TEST(PoseSearch, EveryPathStandsAndEveryReasonIsRight) {
  int found = 0, none = 0, blocked = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    const Plain plain = rooms(random, 30 + static_cast<int>(random() % 40), 30 + static_cast<int>(random() % 40),
                              2 + static_cast<int>(random() % 14));
    const OpenGrid grid = test::to_grid(plain);
    const Footprint footprint = test::random_footprint(random, 1, 5);
    const double turn_radius = random() % 2 == 0 ? 0 : test::uniform(random, 0.5, 8);
    PoseSearch search(grid, footprint, turn_radius * kChordRadius);
    for (int i = 0; i < 4; ++i) {
      const Pose start = any_pose(random, plain), goal = any_pose(random, plain);
      const PoseRoute route = search.find(start, goal, little());
      ASSERT_EQ(route.poses.empty(), route.outcome != PoseOutcome::kFound);
      switch (route.outcome) {
        case PoseOutcome::kFound:
          ++found;
          ASSERT_EQ(route.poses.front().p, start.p);
          ASSERT_EQ(route.poses.back().p, goal.p);
          ASSERT_EQ(fault(grid, footprint, turn_radius, route.poses), std::nullopt) << seed;
          ASSERT_LT(worst_overlap(plain, footprint, route.poses), 1e-4) << seed;
          break;
        case PoseOutcome::kStartBlocked:
          ++blocked;
          ASSERT_GT(test::worst_overlap(plain, footprint.polygon(), start), 0) << seed;
          break;
        case PoseOutcome::kGoalBlocked:
          ASSERT_GT(test::worst_overlap(plain, footprint.polygon(), goal), 0) << seed;
          break;
        case PoseOutcome::kNoWay:
          ++none;
          ASSERT_FALSE(disc_gets_there(plain, footprint.inscribed(), start.p, goal.p)) << seed;
          break;
        case PoseOutcome::kGaveUp: break;
        case PoseOutcome::kStopped: FAIL() << "nobody stopped it";
      }
    }
  }
  EXPECT_GT(found, 35);
  EXPECT_GT(none, 5);
  EXPECT_GT(blocked, 40);
}

TEST(PoseSearch, AfterChangesItIsAsIfItWereNew) {
  for (unsigned seed = 0; seed < 15; ++seed) {
    std::mt19937 random(seed);
    Plain plain = rooms(random, 50, 40, 9);
    OpenGrid grid = test::to_grid(plain);
    const Footprint footprint = test::random_footprint(random, 1, 3);
    ExtraCosts extra(grid);
    PoseSearch search(grid, footprint, 2, &extra);
    for (int i = 0; i < 6; ++i) {
      const Window window = test::random_change(random, plain, grid);
      for (int y = window.low.y; y <= window.high.y; ++y) {
        for (int x = window.low.x; x <= window.high.x; ++x) extra.set({x, y}, static_cast<int>(random() % 16));
      }
      search.update(window);
      const Pose start = any_pose(random, plain), goal = any_pose(random, plain);
      const PoseRoute kept = search.find(start, goal, little());
      const PoseRoute anew = PoseSearch(grid, footprint, 2, &extra).find(start, goal, little());
      ASSERT_EQ(kept.outcome, anew.outcome) << seed;
      ASSERT_EQ(kept.poses.size(), anew.poses.size()) << seed;
      for (std::size_t k = 0; k < kept.poses.size(); ++k) {
        ASSERT_EQ(kept.poses[k].p, anew.poses[k].p);
        ASSERT_EQ(kept.poses[k].yaw, anew.poses[k].yaw);
      }
    }
  }
}

/// Two rooms and a passage of `wide` rows between them.
Plain passage(int wide) {
  Plain plain = test::all_open(90, 41);
  for (int x = 40; x < 50; ++x) {
    for (int y = 0; y < 41; ++y) {
      if (y < 20 - wide / 2 || y >= 20 - wide / 2 + wide) plain.set(x, y, false);
    }
  }
  return plain;
}

TEST(PoseSearch, FitsThroughWhatIsAsWideAsItself) {
  for (const int wide : {8, 9, 12}) {
    for (const double turn_radius : {0.0, 5.0}) {
      const OpenGrid grid = test::to_grid(passage(wide));
      const Footprint footprint = *make_rectangle(14, wide);
      PoseSearch search(grid, footprint, turn_radius * kChordRadius);
      const PoseRoute route = search.find({{15, 20}, 1}, {{70, 25}, -2});
      ASSERT_EQ(route.outcome, PoseOutcome::kFound) << wide << ", " << turn_radius;
      EXPECT_EQ(fault(grid, footprint, turn_radius, route.poses), std::nullopt);
    }
  }
}

/// Two halls and two doors of 12 cells between them.
Plain two_doors() {
  Plain plain = test::all_open(90, 61);
  for (int y = 0; y < 61; ++y) {
    const bool is_door = (y >= 8 && y < 20) || (y >= 41 && y < 53);
    if (!is_door) plain.set(45, y, false);
  }
  return plain;
}

double highest_at_wall(const PoseRoute& route) {
  double highest = 0;
  for (const Pose& pose : route.poses) {
    if (std::abs(pose.p.x() - 45) < 12) highest = std::max(highest, pose.p.y());
  }
  return highest;
}

TEST(PoseSearch, GoesRoundWhatIsDearAndThroughWhereThereIsNoOtherWay) {
  const Plain plain = two_doors();
  const OpenGrid grid = test::to_grid(plain);
  const Footprint footprint = *make_rectangle(10, 6);
  const Pose start{{15, 14}, 0}, goal{{75, 14}, 0};
  for (const double turn_radius : {0.0, 4.0}) {
    ExtraCosts extra(grid);
    const auto find = [&] {
      PoseRoute route = PoseSearch(grid, footprint, turn_radius * kChordRadius, &extra).find(start, goal);
      EXPECT_EQ(route.outcome, PoseOutcome::kFound);
      EXPECT_EQ(route.means, PoseMeans::kGuided);
      EXPECT_EQ(fault(grid, footprint, turn_radius, route.poses), std::nullopt);
      return route;
    };
    EXPECT_LT(highest_at_wall(find()), 20);
    const auto set_box = [&](Cell low, Cell high, int cost) {
      for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) extra.set({x, y}, cost);
      }
    };
    set_box({38, 0}, {52, 25}, 15);
    EXPECT_GT(highest_at_wall(find()), 40) << "by the other door";
    set_box({38, 0}, {52, 25}, 1);
    EXPECT_LT(highest_at_wall(find()), 20) << "a little is no reason for a detour";
    set_box({38, 0}, {52, 60}, 15);
    EXPECT_LT(highest_at_wall(find()), 20) << "dear everywhere: the shorter way";
  }
}

TEST(PoseSearch, SaysAtOnceThatEveryDoorIsTooNarrow) {
  const OpenGrid grid = test::to_grid(passage(8));
  PoseSearch search(grid, *make_rectangle(14, 10), 5);
  const PoseRoute route = search.find({{15, 20}, 1}, {{70, 25}, -2});
  EXPECT_EQ(route.outcome, PoseOutcome::kNoWay);
  EXPECT_EQ(route.steps, 0);
}

TEST(PoseSearch, GivesUpWithinItsEffort) {
  // A dead end that it cannot turn in: it would have to come out as it went in.
  Plain plain = test::all_open(60, 40);
  for (int x = 0; x < 60; ++x) {
    for (int y = 0; y < 40; ++y) {
      if (y < 15 || y >= 25) plain.set(x, y, false);
    }
  }
  const OpenGrid grid = test::to_grid(plain);
  PoseSearch search(grid, *make_rectangle(14, 8), 5);
  const PoseRoute route = search.find({{15, 20}, 0}, {{40, 20}, M_PI}, little());
  EXPECT_EQ(route.outcome, PoseOutcome::kGaveUp);
  EXPECT_GT(route.steps, 0);
  EXPECT_LE(route.steps, 3 * little().guided + little().corridor + little().anywhere + 2);
}

TEST(PoseSearch, StopsWhenItIsTold) {
  const OpenGrid grid = test::to_grid(passage(10));
  PoseSearch search(grid, *make_rectangle(14, 8), 5);
  for (const int after : {0, 3, 10}) {
    PoseEffort effort;
    int asked = 0;
    effort.stop = [&] { return asked++ >= after; };
    const PoseRoute route = search.find({{15, 20}, 1}, {{70, 25}, -2}, effort);
    EXPECT_EQ(route.outcome, PoseOutcome::kStopped) << after;
    EXPECT_TRUE(route.poses.empty());
  }
}

TEST(PoseSearch, TakesAnyPose) {
  const OpenGrid grid = test::to_grid(passage(10));
  PoseSearch search(grid, *make_rectangle(14, 8), 5);
  const Pose good{{15, 20}, 0};
  for (const Pose& bad : {Pose{{NAN, 1}, 0}, Pose{{15, 20}, NAN}, Pose{{1e300, 20}, 0}, Pose{{-5, 20}, 0}}) {
    EXPECT_EQ(search.find(bad, good).outcome, PoseOutcome::kStartBlocked);
    EXPECT_EQ(search.find(good, bad).outcome, PoseOutcome::kGoalBlocked);
  }
  EXPECT_EQ(search.find(good, good).outcome, PoseOutcome::kFound);
  EXPECT_EQ(search.find({{15, 20}, 1e6}, good).outcome, PoseOutcome::kFound);
}

TEST(PoseCheck, FindsWhatIsWrong) {
  Plain plain = passage(12);
  OpenGrid grid = test::to_grid(plain);
  const Footprint footprint = *make_rectangle(14, 8);
  const std::vector<Pose> straight{{{15, 20}, 0}, {{75, 20}, 0}};
  EXPECT_EQ(fault(grid, footprint, 5, straight), std::nullopt);
  EXPECT_NE(fault_of({grid, 1, footprint, 5, straight[1], straight[1]}, straight), std::nullopt);
  EXPECT_NE(fault_of({grid, 1, footprint, 5, straight[0], straight[0]}, straight), std::nullopt);
  EXPECT_NE(fault_of({grid, 1, footprint, 5, straight[0], straight[0]}, {}), std::nullopt);
  EXPECT_NE(fault(grid, footprint, 5, {{{15, 20}, 0}, {{15, 24}, 0}}), std::nullopt) << "sideways";
  EXPECT_NE(fault(grid, footprint, 5, {{{15, 20}, 0}, {{15, 20}, 1}}), std::nullopt) << "turns in place";
  EXPECT_EQ(fault(grid, footprint, 0, {{{15, 20}, 0}, {{15, 20}, 1}}), std::nullopt);
  const Move arc{2, 0.5};
  EXPECT_EQ(fault(grid, footprint, 3.9, {{{15, 20}, 0}, arc.from({{15, 20}, 0})}), std::nullopt);
  EXPECT_NE(fault(grid, footprint, 4.1, {{{15, 20}, 0}, arc.from({{15, 20}, 0})}), std::nullopt) << "too tight";
  EXPECT_NE(fault(grid, footprint, 0, {{{15, 20}, 0}, {{15, 20}, NAN}}), std::nullopt);
  EXPECT_NE(fault(grid, footprint, 5, {{{15, 20}, 0}, {{89, 20}, 0}}), std::nullopt) << "off the grid";
  // One cell in the way, between the two poses and away from the outline.
  grid.set({45, 20}, false);
  EXPECT_NE(fault(grid, footprint, 5, straight), std::nullopt);
}

TEST(PoseCheck, MeasuresTheFootprintsClearance) {
  const OpenGrid grid = test::to_grid(passage(12));
  const Footprint footprint = *make_rectangle(14, 8);
  const std::vector<Pose> straight{{{15, 20}, 0}, {{75, 20}, 0}};
  const PoseClearance clearance = clearance_of({grid, 1, footprint, 5, straight[0], straight[1]}, straight, 10);
  EXPECT_NEAR(clearance.least, 2, 1e-9);
  ASSERT_EQ(clearance.at.size(), 2U);
  EXPECT_NEAR(clearance.at[0], 8, 1e-9);
  EXPECT_NEAR(clearance.at[1], 8, 1e-9);
}

}  // namespace
}  // namespace concord
