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

ClearPath ClearanceSearch::shorten(std::vector<Cell> cells) const {
  const std::size_t last = cells.size() - 1;
  // What the path costs up to each cell.
  std::vector<std::int64_t> sums(cells.size(), 0);
  for (std::size_t i = 1; i <= last; ++i) sums[i] = sums[i - 1] + step(cells[i - 1], cells[i]);
  const auto is_as_good = [&](std::size_t from, std::size_t to) {
    if (to == from + 1) return true;
    if (!sees(grid_, cells[from], cells[to])) return false;
    // Each step's cost is rounded down by less than one.
    if (line_cost(cells[from], cells[to]) > sums[to] - sums[from] + static_cast<std::int64_t>(to - from)) return false;
    int least = field_.reach() * field_.reach();
    for (std::size_t i = from; i <= to; ++i) least = std::min<int>(least, field_.squared(cells[i]));
    return least_on_line(cells[from], cells[to]) >= least && (!also_ || also_(cells[from], cells[to]));
  };
  ClearPath path;
  path.cost = sums[last];
  path.expanded = expanded_;
  path.turns.push_back(cells.front());
  path.least_squared = field_.reach() * field_.reach();
  for (std::size_t from = 0; from < last;) {
    // The furthest that is as good, as far as doubling and then halving of the step tells.
    std::size_t to = from + 1;
    std::size_t step = 1;
    for (; to < last && is_as_good(from, std::min(to + step, last)); step *= 2) to = std::min(to + step, last);
    for (step /= 2; step > 0; step /= 2) {
      if (to + step <= last && is_as_good(from, to + step)) to += step;
    }
    path.length += between(cells[from], cells[to]);
    path.least_squared = std::min(path.least_squared, least_on_line(cells[from], cells[to]));
    path.turns.push_back(cells[to]);
    from = to;
  }
  path.least_squared = std::min<int>(path.least_squared, field_.squared(cells.front()));
  path.cells = std::move(cells);
  return path;
}

}  // namespace concord
