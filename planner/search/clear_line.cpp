// How ClearanceSearch replaces cells by straight lines.
#include <algorithm>
#include <cmath>

#include "planner/lattice/sight.hpp"
#include "planner/search/clearance_search.hpp"

namespace concord {
namespace {

double between(Cell a, Cell b) { return std::hypot(a.x - b.x, a.y - b.y); }

}  // namespace

/// In the same unit as the steps, and along a line that these can follow the same: the mean factor of the cells that it
/// touches, where the first and the last count half, times its length.
std::int64_t ClearanceSearch::line_cost(Cell from, Cell to) const {
  std::int64_t factors = -(factor_at(from) + factor_at(to));
  std::int64_t cells = -1;
  LineOfCells(from, to).for_each_cell([&](Cell cell) {
    factors += 2 * factor_at(cell);
    ++cells;
  });
  return std::llround(between(from, to) * static_cast<double>(kStraightStep * factors) /
                      static_cast<double>(2 * cells * ClearanceCost::kUnit));
}

int ClearanceSearch::least_on_line(Cell from, Cell to) const {
  int least = field_.reach() * field_.reach();
  LineOfCells(from, to).for_each_cell([&](Cell cell) { least = std::min<int>(least, field_.squared(cell)); });
  return least;
}

/// Of the cells from `first` to `last`, as they are; those behind cost as much more as they did.
void ClearanceSearch::sum_up(ClearPath& path, std::size_t first, std::size_t last) const {
  for (std::size_t i = std::max<std::size_t>(first, 1); i <= last; ++i) {
    path.sums[i] = path.sums[i - 1] + step(path.cells[i - 1], path.cells[i]);
  }
}

void ClearanceSearch::follow(ClearPath& path, std::size_t first, std::size_t last) const {
  const std::size_t end = path.cells.size() - 1;
  const std::size_t to = std::min(last + 1, end);  // the step out of it, too
  const std::int64_t before = path.sums[to];
  sum_up(path, first, to);
  const std::int64_t more = path.sums[to] - before;
  for (std::size_t i = to + 1; i <= end; ++i) path.sums[i] += more;
  path.cost = path.sums[end];
}

/// Appends the turns behind cell `from`, which is one, up to `last`.
void ClearanceSearch::draw_lines(ClearPath& path, std::size_t from, std::size_t last) const {
  const std::vector<Cell>& cells = path.cells;
  const auto is_as_good = [&](std::size_t a, std::size_t b) {
    if (b == a + 1) return true;
    if (!sees(grid_, cells[a], cells[b])) return false;
    // Each step's cost is rounded down by less than one.
    if (line_cost(cells[a], cells[b]) > path.sums[b] - path.sums[a] + static_cast<std::int64_t>(b - a)) return false;
    int least = field_.reach() * field_.reach();
    for (std::size_t i = a; i <= b; ++i) least = std::min<int>(least, field_.squared(cells[i]));
    return least_on_line(cells[a], cells[b]) >= least && (!also_ || also_(cells[a], cells[b]));
  };
  while (from < last) {
    // The furthest that is as good, as far as doubling and then halving of the step tells.
    std::size_t to = from + 1;
    std::size_t step = 1;
    for (; to < last && is_as_good(from, std::min(to + step, last)); step *= 2) to = std::min(to + step, last);
    for (step /= 2; step > 0; step /= 2) {
      if (to + step <= last && is_as_good(from, to + step)) to += step;
    }
    path.length += between(cells[from], cells[to]);
    path.turns.push_back(cells[to]);
    path.at.push_back(to);
    from = to;
  }
}

ClearPath ClearanceSearch::shorten(std::vector<Cell> cells) const {
  ClearPath path;
  path.cells = std::move(cells);
  path.sums.resize(path.cells.size());
  sum_up(path, 1, path.cells.size() - 1);
  path.cost = path.sums.back();
  path.expanded = expanded_;
  path.turns.push_back(path.cells.front());
  path.at.push_back(0);
  draw_lines(path, 0, path.cells.size() - 1);
  return path;
}

ClearPath ClearanceSearch::shorten_again(std::vector<Cell> cells, const ClearPath& old, std::size_t first,
                                         std::size_t last, const Window& changed) const {
  const auto comes_near = [&](std::size_t turn) {
    const Cell a = old.turns[turn], b = old.turns[turn + 1];
    return std::max(a.x, b.x) >= changed.low.x && std::min(a.x, b.x) <= changed.high.x &&
           std::max(a.y, b.y) >= changed.low.y && std::min(a.y, b.y) <= changed.high.y;
  };
  // Turns up to the first and from the second on stay.
  std::size_t kept = 0, again = old.turns.size() - 1;
  while (kept + 1 < old.at.size() && old.at[kept + 1] <= first && !comes_near(kept)) ++kept;
  while (again > kept && again > 0 && old.at[again - 1] >= last && !comes_near(again - 1)) --again;
  ClearPath path;
  path.cells = std::move(cells);
  path.expanded = expanded_;
  const std::size_t behind = old.cells.size() - old.at[again];
  const std::size_t to = path.cells.size() - behind;
  path.sums.assign(old.sums.begin(), old.sums.begin() + static_cast<std::ptrdiff_t>(first) + 1);
  path.sums.resize(path.cells.size());
  const std::size_t found_to = path.cells.size() - (old.cells.size() - last);
  sum_up(path, first + 1, found_to);
  for (std::size_t i = found_to + 1; i < path.cells.size(); ++i) {
    path.sums[i] = path.sums[found_to] + old.sums[old.cells.size() - (path.cells.size() - i)] - old.sums[last];
  }
  path.cost = path.sums.back();
  path.turns.assign(old.turns.begin(), old.turns.begin() + static_cast<std::ptrdiff_t>(kept) + 1);
  path.at.assign(old.at.begin(), old.at.begin() + static_cast<std::ptrdiff_t>(kept) + 1);
  for (std::size_t i = 1; i <= kept; ++i) path.length += between(path.turns[i - 1], path.turns[i]);
  draw_lines(path, path.at.back(), to);
  for (std::size_t i = again + 1; i < old.turns.size(); ++i) {
    path.length += between(path.turns.back(), old.turns[i]);
    path.turns.push_back(old.turns[i]);
    path.at.push_back(path.cells.size() - (old.cells.size() - old.at[i]));
  }
  return path;
}

}  // namespace concord
