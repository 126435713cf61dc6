#include "planner/search.hpp"

#include <array>
#include <map>
#include <optional>
#include <queue>

#include <gtest/gtest.h>

#include "planner/clearance.hpp"
#include "sketch.hpp"

namespace concord {
namespace {

/// Counts of straight and diagonal steps, compared by true length; the oracle knows nothing of integer costs.
struct Steps {
  int straight = 0, diagonal = 0;
  [[nodiscard]] double length() const { return straight + diagonal * std::sqrt(2.0); }
};

std::optional<double> dijkstra(const std::vector<std::vector<bool>>& open, Cell start, Cell goal) {
  const auto is_open = [&](int x, int y) {
    return y >= 0 && y < static_cast<int>(open.size()) && x >= 0 && x < static_cast<int>(open[y].size()) && open[y][x];
  };
  std::map<Cell, double> best;
  std::map<Cell, bool> done;
  using Entry = std::pair<double, Cell>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  std::map<Cell, Steps> steps{{start, {}}};
  best[start] = 0;
  queue.emplace(0.0, start);
  while (!queue.empty()) {
    const Cell cell = queue.top().second;
    queue.pop();
    if (done[cell]) continue;
    done[cell] = true;
    if (cell == goal) return best[cell];
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Cell next{cell.x + dx, cell.y + dy};
        if ((dx == 0 && dy == 0) || !is_open(next.x, next.y)) continue;
        if (!is_open(cell.x + dx, cell.y) || !is_open(cell.x, cell.y + dy)) continue;
        Steps s = steps[cell];
        (dx != 0 && dy != 0 ? s.diagonal : s.straight)++;
        if (best.contains(next) && best[next] <= s.length()) continue;
        best[next] = s.length();
        steps[next] = s;
        queue.emplace(s.length(), next);
      }
    }
  }
  return std::nullopt;
}

double octile(const std::vector<Cell>& cells) {
  Steps s;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    (cells[i].x != cells[i - 1].x && cells[i].y != cells[i - 1].y ? s.diagonal : s.straight)++;
  }
  return s.length();
}

constexpr int kWidth = 40, kHeight = 30;

TEST(FreeSpace, OpenCellsAreThoseWhoseDiscIsFree) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    std::mt19937 random(seed);
    const std::array<double, 6> radii{0.0, 0.5, 1.0, 1.5, 2.3, 0.01 * static_cast<double>(random() % 900)};
    const double radius = radii[seed % radii.size()];
    const Cell origin{static_cast<std::int32_t>(random() % 200) - 100, static_cast<std::int32_t>(random() % 200) - 100};
    const Grid grid = test::sketch(test::strewn(random, kWidth, kHeight, 0.01, 0.003), origin);
    FreeSpace space(grid, radius);
    for (std::int32_t y = origin.y - 2; y < origin.y + kHeight + 2; ++y) {
      for (std::int32_t x = origin.x - 2; x < origin.x + kWidth + 2; ++x) {
        const double gap = test::nearest_blocked(grid, x + 0.5, y + 0.5, radius + 1);
        ASSERT_EQ(space.is_open({x, y}), gap > 0 && gap >= radius) << "seed " << seed << " cell " << x << " " << y;
      }
    }
  }
}

TEST(FreeSpace, ADiscWiderThanATileIsRightToo) {
  std::vector<std::string> rows(400, std::string(400, '.'));
  rows[30][35] = '#';
  const Grid grid = test::sketch(rows);
  FreeSpace space(grid, 150.0);
  for (std::int32_t y = 140; y < 260; y += 3) {
    for (std::int32_t x = 140; x < 260; x += 3) {
      const double to_post = test::distance(x + 0.5, y + 0.5, {35, 30});
      const double to_border = std::min({x + 0.5, y + 0.5, 399.5 - x, 399.5 - y});
      ASSERT_EQ(space.is_open({x, y}), std::min(to_post, to_border) >= 150.0) << x << " " << y;
    }
  }
}

TEST(FreeSpace, SeesWhatTheValidatorFindsClear) {
  int seen = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    const Cell origin{static_cast<std::int32_t>(random() % 200) - 100, static_cast<std::int32_t>(random() % 200) - 100};
    const Grid grid = test::sketch(test::strewn(random, kWidth, kHeight, 0.006, 0.002), origin);
    const double radius = seed % 3 == 0 ? 0.0 : 0.25 * static_cast<double>(random() % 8);
    FreeSpace space(grid, radius);
    // Half of the points on the half-cell lattice, where lines touch corners exactly.
    const auto point = [&] {
      Eigen::Vector2d p(origin.x + 0.5 * static_cast<double>(random() % (2 * kWidth)),
                        origin.y + 0.5 * static_cast<double>(random() % (2 * kHeight)));
      if (seed % 2 == 0)
        p += Eigen::Vector2d(1e-3 * static_cast<double>(random() % 500), 1e-3 * static_cast<double>(random() % 500));
      return p;
    };
    for (int i = 0; i < 60; ++i) {
      const std::array<Eigen::Vector2d, 2> line{point(), point()};
      const bool clear = is_clear(grid, line, radius);
      ASSERT_EQ(space.sees(line[0], line[1]), clear)
          << "seed " << seed << " r " << radius << " " << line[0].transpose() << " to " << line[1].transpose();
      ASSERT_EQ(space.sees(line[1], line[0]), clear);
      seen += clear ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 1000);
}

TEST(Search, FindsTheShortestWayOrNone) {
  int found = 0;
  int none = 0;
  for (unsigned seed = 0; seed < 400; ++seed) {
    std::mt19937 random(seed);
    const Cell origin{static_cast<std::int32_t>(random() % 128) - 64, static_cast<std::int32_t>(random() % 128) - 64};
    const auto rows = test::strewn(random, kWidth, kHeight, 0.1 + 0.001 * static_cast<double>(random() % 300), 0.02);
    const Grid grid = test::sketch(rows, origin);
    FreeSpace space(grid, seed % 4 == 0 ? 0.6 : 0.0);
    std::vector<std::vector<bool>> open(kHeight, std::vector<bool>(kWidth));
    std::vector<Cell> cells;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        open[y][x] = space.is_open({origin.x + x, origin.y + y});
        if (open[y][x]) cells.push_back({x, y});
      }
    }
    if (cells.empty()) continue;
    const Cell from = cells[random() % cells.size()];
    const Cell to = cells[random() % cells.size()];
    const std::optional<double> shortest = dijkstra(open, from, to);

    const Anchor start{{from.x + origin.x, from.y + origin.y}, 0};
    const Anchor goal{{to.x + origin.x, to.y + origin.y}, 0};
    const CellPath path = find_path(space, {&start, 1}, {&goal, 1}, 1'000'000);
    ASSERT_EQ(path.status == CellPath::Status::kFound, shortest.has_value()) << "seed " << seed;
    ++(shortest ? found : none);
    if (!shortest) continue;
    ASSERT_EQ(path.cells.front(), start.cell);
    ASSERT_EQ(path.cells.back(), goal.cell);
    ASSERT_NEAR(octile(path.cells), *shortest, 1e-9) << "seed " << seed;
    ASSERT_NEAR(static_cast<double>(path.cost) / kStraight, *shortest, 1e-9);
    for (std::size_t i = 1; i < path.cells.size(); ++i) {
      const Cell a = path.cells[i - 1];
      const Cell b = path.cells[i];
      ASSERT_LE(std::max(std::abs(a.x - b.x), std::abs(a.y - b.y)), 1);
      ASSERT_TRUE(space.is_open({a.x, b.y}) && space.is_open({b.x, a.y}) && space.is_open(b));
    }
  }
  EXPECT_GT(found, 100);
  EXPECT_GT(none, 50);
}

TEST(Search, ChoosesTheCheapestOfSeveralEnds) {
  const Grid grid = test::sketch({"...........", "...........", "..........."});
  FreeSpace space(grid, 0);
  const std::array<Anchor, 2> starts{{{{0, 1}, 0}, {{4, 1}, 3 * kStraight}}};
  const std::array<Anchor, 2> goals{{{{6, 1}, 3 * kStraight}, {{10, 1}, 0}}};
  const CellPath path = find_path(space, starts, goals, 1000);
  EXPECT_EQ(path.cost, 8 * kStraight);
  EXPECT_EQ(path.cells.front(), (Cell{4, 1}));
  EXPECT_EQ(path.cells.back(), (Cell{6, 1}));
}

TEST(Search, GivesUpAtItsBound) {
  const Grid grid = test::sketch(std::vector<std::string>(50, std::string(50, '.')));
  FreeSpace space(grid, 0);
  const Anchor start{{1, 1}, 0};
  const Anchor goal{{48, 40}, 0};
  const CellPath path = find_path(space, {&start, 1}, {&goal, 1}, 10);
  EXPECT_EQ(path.status, CellPath::Status::kGaveUp);
  EXPECT_EQ(path.expanded, 10);
}

}  // namespace
}  // namespace concord
