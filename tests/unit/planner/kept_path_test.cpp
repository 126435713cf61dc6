#include "planner/search/kept_path.hpp"

#include <gtest/gtest.h>

#include "lattice.hpp"
#include "planner/lattice/sight.hpp"

namespace concord {
namespace {

using test::Plain;

/// By plain Bellman and Ford: steps until nothing gets cheaper.
std::optional<std::int64_t> cheapest(const Plain& plain, const DistanceField& field, Cell from, Cell to) {
  const ClearanceCost costs(field.reach());
  std::vector<std::int64_t> best(plain.open.size(), std::numeric_limits<std::int64_t>::max());
  const auto at = [&](Cell c) -> std::int64_t& { return best[static_cast<std::size_t>(c.y) * plain.width + c.x]; };
  if (!plain.at(from.x, from.y)) return std::nullopt;
  at(from) = 0;
  std::vector<Cell> changed{from};
  while (!changed.empty()) {
    std::vector<Cell> next;
    for (const Cell cell : changed) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const Cell other{cell.x + dx, cell.y + dy};
          if (other == cell || !plain.can_step(cell, other)) continue;
          const int factors = costs.factor(field.squared(cell)) + costs.factor(field.squared(other));
          const std::int64_t cost = at(cell) + (dx != 0 && dy != 0 ? 181 : 128) * factors / 32;
          if (cost >= at(other)) continue;
          at(other) = cost;
          next.push_back(other);
        }
      }
    }
    changed = std::move(next);
  }
  const std::int64_t cost = plain.at(to.x, to.y) ? at(to) : std::numeric_limits<std::int64_t>::max();
  return cost == std::numeric_limits<std::int64_t>::max() ? std::nullopt : std::optional(cost);
}

void expect_good(const GridPaths& paths, const ClearPath& path, Cell from, Cell to) {
  ASSERT_EQ(path.turns.front(), from);
  ASSERT_EQ(path.turns.back(), to);
  ASSERT_EQ(path.cells.front(), from);
  ASSERT_EQ(path.cells.back(), to);
  for (std::size_t i = 1; i < path.turns.size(); ++i) {
    ASSERT_TRUE(sees(paths.grid(), path.turns[i - 1], path.turns[i]));
  }
  for (std::size_t i = 1; i < path.cells.size(); ++i) {
    ASSERT_TRUE(sees(paths.grid(), path.cells[i - 1], path.cells[i]));
    ASSERT_LE(std::abs(path.cells[i].x - path.cells[i - 1].x), 1);
    ASSERT_LE(std::abs(path.cells[i].y - path.cells[i - 1].y), 1);
  }
}

TEST(Clearance, IsTheCheapestAndItsStraightLinesComeNoNearer) {
  for (unsigned seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const Plain plain = test::random_plain(random, 30);
    GridPaths paths(test::to_grid(plain), 6);
    paths.prepare_clear();
    for (int i = 0; i < 10; ++i) {
      const Cell a = test::random_open(random, plain);
      const Cell b{static_cast<int>(random() % plain.width), static_cast<int>(random() % plain.height)};
      const auto path = paths.clear(a, b);
      const auto best = cheapest(plain, paths.field(), a, b);
      ASSERT_EQ(path.has_value(), best.has_value());
      if (!path) continue;
      ASSERT_EQ(path->cost, *best);
      ASSERT_EQ(path->cost, paths.clearance().cost(path->cells));
      expect_good(paths, *path, a, b);
      int least = 36;
      for (const Cell cell : path->cells) least = std::min<int>(least, paths.field().squared(cell));
      int lines = 36;
      for (std::size_t k = 1; k < path->turns.size(); ++k) {
        LineOfCells(path->turns[k - 1], path->turns[k]).for_each_cell([&](Cell cell) {
          // A step of the path itself may touch cells beside it.
          const bool is_step = std::abs(path->turns[k].x - path->turns[k - 1].x) <= 1 &&
                               std::abs(path->turns[k].y - path->turns[k - 1].y) <= 1;
          if (!is_step) lines = std::min<int>(lines, paths.field().squared(cell));
        });
      }
      ASSERT_GE(lines, least);
    }
  }
}

TEST(KeptPath, HoldsAtEveryChangeAndIsNeverMuchCostlierThanTheBest) {
  int outcomes[4] = {};
  for (unsigned seed = 0; seed < 120; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Plain plain = test::random_plain(random, seed % 4 == 0 ? 400 : 100);
    GridPaths paths(test::to_grid(plain));
    KeptPath kept(paths);
    const Cell a = test::random_open(random, plain);
    const Cell b = test::random_open(random, plain);
    if (!plain.at(a.x, a.y)) continue;
    kept.plan(a, b);
    bool opened_since = false;
    for (int change = 0; change < 25; ++change) {
      OpenGrid copy = paths.grid();
      std::optional<Cell> at;  // every other change is on the path
      if (kept.path() && change % 2 == 0) at = kept.path()->cells[random() % kept.path()->cells.size()];
      const Window window = test::random_change(random, plain, copy, at);
      const bool opened = paths.update(window, [&](OpenGrid& grid) { grid = copy; });
      opened_since = opened_since || opened;
      const auto before = kept.path();
      const KeptPath::Outcome outcome = kept.follow(window, opened);
      ++outcomes[static_cast<int>(outcome)];
      const auto best = paths.clear(a, b);
      ASSERT_EQ(kept.path().has_value(), best.has_value());
      ASSERT_EQ(outcome == KeptPath::Outcome::kUnreachable, !best);
      if (!best) continue;
      expect_good(paths, *kept.path(), a, b);
      ASSERT_TRUE(outcome != KeptPath::Outcome::kKept || kept.path()->turns == before->turns);
      ASSERT_EQ(kept.path()->cost, paths.clearance().cost(kept.path()->cells));
      // A path that nothing was opened for since is as good as it was; else it is after a look.
      const bool improved = kept.improve();
      ASSERT_TRUE(!improved || opened_since);
      opened_since = false;
      if (improved) expect_good(paths, *kept.path(), a, b);
      ASSERT_LE(static_cast<double>(kept.path()->cost), 1.25 * static_cast<double>(best->cost));
    }
  }
  for (const int count : outcomes) EXPECT_GT(count, 10) << outcomes[0] << ' ' << outcomes[1] << ' ' << outcomes[2];
}

}  // namespace
}  // namespace concord
