#include "planner/scenario/path_check.hpp"

#include <algorithm>
#include <cstdlib>

namespace concord {
namespace {

/// Whether the closed square of `cell` meets the segment, by the three axes that can part them. Everything is doubled,
/// so that corners are whole.
bool touches(Cell from, Cell to, Cell cell) {
  const std::int64_t x0 = 2 * std::int64_t{from.x}, y0 = 2 * std::int64_t{from.y};
  const std::int64_t x1 = 2 * std::int64_t{to.x}, y1 = 2 * std::int64_t{to.y};
  const std::int64_t cx = 2 * std::int64_t{cell.x}, cy = 2 * std::int64_t{cell.y};
  if (std::max(x0, x1) < cx - 1 || std::min(x0, x1) > cx + 1) return false;
  if (std::max(y0, y1) < cy - 1 || std::min(y0, y1) > cy + 1) return false;
  const std::int64_t dx = x1 - x0, dy = y1 - y0;
  return std::abs(dx * (cy - y0) - dy * (cx - x0)) <= std::abs(dx) + std::abs(dy);
}

bool is_open_along(const OpenGrid& grid, Cell from, Cell to) {
  const std::int64_t dx = to.x - from.x;
  const std::int64_t dy = to.y - from.y;
  for (int y = std::min(from.y, to.y) - 1; y <= std::max(from.y, to.y) + 1; ++y) {
    // Where the segment is in the rows from y - 1 to y + 1, and a cell more.
    const auto at = [&](std::int64_t row) {
      const std::int64_t part =
          std::clamp<std::int64_t>(row - from.y, std::min<std::int64_t>(dy, 0), std::max<std::int64_t>(dy, 0));
      return dy == 0 ? std::int64_t{from.x} : from.x + dx * part / dy;
    };
    std::int64_t first = std::min(at(y - 1), at(y + 1)) - 2;
    std::int64_t last = std::max(at(y - 1), at(y + 1)) + 2;
    if (dy == 0) {
      first = std::min(from.x, to.x) - 1;
      last = std::max(from.x, to.x) + 1;
    }
    for (std::int64_t x = first; x <= last; ++x) {
      const Cell cell{static_cast<std::int32_t>(x), y};
      if (!grid.is_open(cell) && touches(from, to, cell)) return false;
    }
  }
  return true;
}

}  // namespace

bool stays_in_open_cells(const OpenGrid& grid, const std::vector<Cell>& turns) {
  if (turns.empty() || !grid.is_open(turns.front())) return false;
  for (std::size_t i = 1; i < turns.size(); ++i) {
    if (!is_open_along(grid, turns[i - 1], turns[i])) return false;
  }
  return true;
}

}  // namespace concord
