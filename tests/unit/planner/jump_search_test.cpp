#include "planner/search/jump_search.hpp"

#include <gtest/gtest.h>

#include "lattice.hpp"
#include "planner/lattice/components.hpp"

namespace concord {
namespace {

using test::Plain;

/// Step by step over cells that can be stepped on; returns the length walked.
double walk(const Plain& plain, const std::vector<Cell>& turns) {
  double length = 0;
  for (std::size_t i = 1; i < turns.size(); ++i) {
    const int dx = turns[i].x - turns[i - 1].x;
    const int dy = turns[i].y - turns[i - 1].y;
    EXPECT_TRUE((dx != 0 || dy != 0) && (dx == 0 || dy == 0 || std::abs(dx) == std::abs(dy)));
    Cell at = turns[i - 1];
    const Cell step{(dx > 0) - (dx < 0), (dy > 0) - (dy < 0)};
    while (at != turns[i]) {
      const Cell next{at.x + step.x, at.y + step.y};
      if (!plain.can_step(at, next)) ADD_FAILURE() << "stepped over a blocked cell";
      if (!plain.at(next.x, next.y)) return length;
      length += std::hypot(step.x, step.y);
      at = next;
    }
  }
  return length;
}

void expect_exact(const Plain& plain, JumpSearch& search, Components& components, std::mt19937& random) {
  const Cell start = test::random_open(random, plain);
  if (!plain.at(start.x, start.y)) return;
  const std::vector<double> lengths = test::dijkstra(plain, start);
  for (int i = 0; i < 20; ++i) {
    const Cell goal{static_cast<int>(random() % plain.width), static_cast<int>(random() % plain.height)};
    const double length = lengths[static_cast<std::size_t>(goal.y) * plain.width + goal.x];
    const auto path = search.find(start, goal);
    ASSERT_EQ(path.has_value(), std::isfinite(length));
    ASSERT_EQ(path.has_value(), plain.at(goal.x, goal.y) && components.connected(start, goal));
    if (!path) continue;
    ASSERT_EQ(path->turns.front(), start);
    ASSERT_EQ(path->turns.back(), goal);
    ASSERT_NEAR(walk(plain, path->turns), length, 1e-6);
    ASSERT_NEAR(static_cast<double>(path->cost) / kStraight, length, 1e-6);
  }
}

TEST(JumpSearch, IsExactOnAnyMapWhileItChanges) {
  for (unsigned seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Plain plain = test::random_plain(random, seed % 10 == 0 ? 150 : 40);
    OpenGrid grid = test::to_grid(plain);
    JumpGraph graph(grid);
    Components components(grid);
    JumpSearch search(graph);
    for (int change = 0; change < 12; ++change) {
      if (seed % 3 == 0) graph.complete();
      expect_exact(plain, search, components, random);
      if (testing::Test::HasFailure()) return;
      const Window window = test::random_change(random, plain, grid);
      graph.update(window);
      components.update(window);
    }
  }
}

TEST(JumpSearch, AGraphThatWasChangedGivesTheSamePathsAsAFreshOne) {
  std::mt19937 random(7);
  Plain plain = test::random_plain(random, 200);
  OpenGrid grid = test::to_grid(plain);
  JumpGraph graph(grid);
  JumpSearch search(graph);
  for (int change = 0; change < 300; ++change) {
    graph.update(test::random_change(random, plain, grid));
    JumpGraph fresh(grid);
    JumpSearch again(fresh);
    for (int i = 0; i < 5; ++i) {
      const Cell start = test::random_open(random, plain);
      const Cell goal = test::random_open(random, plain);
      const auto path = search.find(start, goal);
      const auto other = again.find(start, goal);
      ASSERT_EQ(path.has_value(), other.has_value());
      ASSERT_TRUE(!path || path->cost == other->cost);
    }
  }
}

TEST(JumpSearch, EndsThatAreNoPlace) {
  OpenGrid grid(3, 1);
  grid.set({0, 0}, true);
  grid.set({2, 0}, true);
  JumpGraph graph(grid);
  JumpSearch search(graph);
  EXPECT_FALSE(search.find({0, 0}, {1, 0}));
  EXPECT_FALSE(search.find({1, 0}, {0, 0}));
  EXPECT_FALSE(search.find({0, 0}, {2, 0}));
  EXPECT_FALSE(search.find({-1, 0}, {0, 0}));
  EXPECT_FALSE(search.find({0, 0}, {0, 1'000'000}));
  EXPECT_FALSE(search.find({0, 0}, {kMaxVoxel, -kMaxVoxel}));
  const auto none = search.find({2, 0}, {2, 0});
  ASSERT_TRUE(none);
  EXPECT_EQ(none->cost, 0);
  EXPECT_EQ(none->turns, std::vector<Cell>({{2, 0}}));
}

}  // namespace
}  // namespace concord
