#include "planner/search/any_angle.hpp"

#include <set>

#include <gtest/gtest.h>

#include "lattice.hpp"
#include "planner/lattice/sight.hpp"
#include "planner/search/grid_paths.hpp"

namespace concord {
namespace {

using test::Plain;

/// Whether the segment between two centres meets the closed square of a cell: clipped against it in fractions.
bool meets(Cell a, Cell b, int x, int y) {
  // In half cells, so that everything is whole; the segment is a + t (b - a), t in [low, high] as fractions.
  const long ax = 2 * a.x, ay = 2 * a.y, dx = 2L * (b.x - a.x), dy = 2L * (b.y - a.y);
  long low_n = 0, low_d = 1, high_n = 1, high_d = 1;
  const auto clip = [&](long p, long d, long from, long to) {
    if (d == 0) return p >= from && p <= to;
    long n0 = from - p, n1 = to - p, q = d;
    if (q < 0) {
      std::swap(n0, n1);
      n0 = -n0, n1 = -n1, q = -q;
    }
    if (n0 * low_d > low_n * q) low_n = n0, low_d = q;
    if (n1 * high_d < high_n * q) high_n = n1, high_d = q;
    return true;
  };
  return clip(ax, dx, 2L * x - 1, 2L * x + 1) && clip(ay, dy, 2L * y - 1, 2L * y + 1) &&
         low_n * high_d <= high_n * low_d;
}

bool sees_plainly(const Plain& plain, Cell a, Cell b) {
  for (int y = std::min(a.y, b.y) - 1; y <= std::max(a.y, b.y) + 1; ++y) {
    for (int x = std::min(a.x, b.x) - 1; x <= std::max(a.x, b.x) + 1; ++x) {
      if (!plain.at(x, y) && meets(a, b, x, y)) return false;
    }
  }
  return true;
}

Cell any_cell(std::mt19937& random, const Plain& plain) {
  return {static_cast<int>(random() % plain.width), static_cast<int>(random() % plain.height)};
}

TEST(Sight, IsWhatPlainGeometrySays) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    const Plain plain = test::random_plain(random, 30);
    const OpenGrid grid = test::to_grid(plain);
    for (int i = 0; i < 100; ++i) {
      const Cell a = any_cell(random, plain);
      const Cell b = any_cell(random, plain);
      ASSERT_EQ(sees(grid, a, b), sees_plainly(plain, a, b)) << seed;
      ASSERT_EQ(sees(grid, a, b), sees(grid, b, a)) << seed;
    }
  }
}

TEST(Sight, TouchesExactlyTheCellsOfTheLine) {
  std::mt19937 random(3);
  const Plain plain = test::all_open(25, 25);
  for (int i = 0; i < 500; ++i) {
    const Cell a = any_cell(random, plain);
    const Cell b = any_cell(random, plain);
    std::set<Cell> touched;
    LineOfCells(a, b).for_each_cell([&](Cell cell) { touched.insert(cell); });
    // A line along a diagonal touches the cells beside its corners; those before its ends lie outside the line's range.
    for (int y = 0; y < plain.height; ++y)
      for (int x = 0; x < plain.width; ++x) ASSERT_EQ(touched.contains({x, y}), meets(a, b, x, y)) << x << ' ' << y;
  }
}

/// The shortest polyline over all cell centres, by Dijkstra's search over all pairs that see each other.
double shortest_polyline(const Plain& plain, Cell from, Cell to) {
  std::vector<double> best(plain.open.size(), std::numeric_limits<double>::infinity());
  std::vector<bool> done(plain.open.size(), false);
  const auto index = [&](Cell c) { return static_cast<std::size_t>(c.y) * plain.width + c.x; };
  best[index(from)] = 0;
  for (;;) {
    std::size_t least = best.size();
    for (std::size_t i = 0; i < best.size(); ++i) {
      if (!done[i] && std::isfinite(best[i]) && (least == best.size() || best[i] < best[least])) least = i;
    }
    if (least == best.size() || least == index(to)) return best[index(to)];
    done[least] = true;
    const Cell at{static_cast<int>(least % plain.width), static_cast<int>(least / plain.width)};
    for (int y = 0; y < plain.height; ++y) {
      for (int x = 0; x < plain.width; ++x) {
        if (!plain.at(x, y) || !sees_plainly(plain, at, {x, y})) continue;
        double& length = best[index({x, y})];
        length = std::min(length, best[least] + std::hypot(x - at.x, y - at.y));
      }
    }
  }
}

TEST(AnyAngle, IsOpenAndNeverLongerThanOverEightDirectionsWhileTheMapChanges) {
  for (unsigned seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Plain plain = test::random_plain(random, 50);
    GridPaths paths(test::to_grid(plain));
    for (int change = 0; change < 6; ++change) {
      for (int i = 0; i < 20; ++i) {
        const Cell a = any_cell(random, plain);
        const Cell b = any_cell(random, plain);
        const auto taut = paths.any_angle(a, b);
        const auto octile = paths.fast(a, b);
        ASSERT_EQ(taut.has_value(), octile.has_value());
        if (!taut) continue;
        ASSERT_EQ(taut->turns.front(), a);
        ASSERT_EQ(taut->turns.back(), b);
        double length = 0;
        for (std::size_t k = 1; k < taut->turns.size(); ++k) {
          ASSERT_TRUE(sees_plainly(plain, taut->turns[k - 1], taut->turns[k]));
          length += std::hypot(taut->turns[k].x - taut->turns[k - 1].x, taut->turns[k].y - taut->turns[k - 1].y);
        }
        ASSERT_NEAR(length, taut->length, 1e-9);
        ASSERT_LE(length, static_cast<double>(octile->cost) / kStraight + 1e-6);
      }
      OpenGrid copy = paths.grid();
      const Window window = test::random_change(random, plain, copy);
      paths.update(window, [&](OpenGrid& grid) { grid = copy; });
    }
  }
}

TEST(AnyAngle, IsNearlyTheShortestOfAllPolylines) {
  double sum = 0;
  int count = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    std::mt19937 random(seed);
    const Plain plain = test::random_plain(random, 16);
    GridPaths paths(test::to_grid(plain));
    for (int i = 0; i < 3; ++i) {
      const Cell a = test::random_open(random, plain);
      const Cell b = test::random_open(random, plain);
      const auto path = paths.any_angle(a, b);
      if (!path || a == b) continue;
      const double ratio = path->length / shortest_polyline(plain, a, b);
      ASSERT_GE(ratio, 1 - 1e-9);
      ASSERT_LE(ratio, 1.1) << seed;
      sum += ratio;
      ++count;
    }
  }
  ASSERT_GT(count, 50);
  EXPECT_LE(sum / count, 1.005);
}

}  // namespace
}  // namespace concord
