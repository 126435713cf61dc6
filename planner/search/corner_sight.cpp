#include "planner/search/corner_sight.hpp"

#include <algorithm>

namespace concord {
namespace {

std::int64_t floor_div(std::int64_t a, std::int64_t b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }
std::int64_t ceil_div(std::int64_t a, std::int64_t b) { return -floor_div(-a, b); }

}  // namespace

CornerSight::CornerSight(const OpenGrid& grid)
    : grid_(grid),
      blocked_(grid.height() + 2, grid.width() + 2, true),
      corners_(grid.height() + 2, grid.width() + 2, false) {
  for (int y = 1; y <= grid.height(); ++y) find_row(y);
}

void CornerSight::update(const Window& window) {
  const int last = std::min(window.high.y + 2, grid_.height());
  for (int y = std::max(window.low.y, 1); y <= last; ++y) find_row(y);
}

void CornerSight::find_row(int y) {
  const BitLines& rows = grid_.rows();
  const std::uint64_t* here = rows.line(y);
  const std::uint64_t* above = rows.line(y + 1);
  const std::uint64_t* below = rows.line(y - 1);
  // Bit x of these is the cell left or right of x.
  const auto left = [](const std::uint64_t* line, int w) { return line[w] << 1 | (w > 0 ? line[w - 1] >> 63 : 0); };
  const auto right = [&](const std::uint64_t* line, int w) {
    return line[w] >> 1 | (w + 1 < rows.words() ? line[w + 1] << 63 : 0);
  };
  for (int w = 0; w < rows.words(); ++w) {
    std::uint64_t corners = 0;
    for (const std::uint64_t* side : {above, below}) {
      corners |= side[w] & ((left(here, w) & ~left(side, w)) | (right(here, w) & ~right(side, w)));
    }
    blocked_.line(y)[w] = ~here[w];
    corners_.line(y)[w] = here[w] & corners;
  }
}

bool CornerSight::is_corner(Cell cell, int x, int y) const {
  return grid_.is_open({cell.x + x, cell.y}) && grid_.is_open({cell.x, cell.y + y}) &&
         !grid_.is_open({cell.x + x, cell.y + y});
}

/// Cells from a bit to the next that is set, in one direction.
int CornerSight::distance_to(const BitLines& lines, int line, int bit, int sign) const {
  return sign > 0 ? lines.next(line, bit) - bit : bit - lines.previous(line, bit);
}

void CornerSight::look(Cell eye, Quadrant quadrant, Slope low, Slope high, std::vector<Cell>& seen) {
  const int free = distance_to(blocked_, eye.y + 1, eye.x + 1, quadrant.x);
  if (high.dy == 0) {
    for (int k = 1; k < free; ++k) {
      const int bit = eye.x + 1 + quadrant.x * k;
      if (corners_.test(eye.y + 1, bit)) seen.push_back({eye.x + quadrant.x * k, eye.y});
    }
  }
  // Within its own row the view ends at the side of the first blocked cell.
  high = std::min(high, Slope{2 * free - 1, 1});
  views_.clear();
  if (low < high) views_.push_back({low, high});
  for (std::int64_t row = 1; !views_.empty(); ++row) {
    next_.clear();
    for (const Interval& view : views_) {
      take(eye, quadrant, row, view, seen);
      narrow(eye, quadrant, row, view);
    }
    std::swap(views_, next_);
  }
}

/// The corners of a row whose centres are in view, and that nothing of the same row hides.
void CornerSight::take(Cell eye, Quadrant quadrant, std::int64_t row, const Interval& view,
                       std::vector<Cell>& seen) const {
  const int line = eye.y + 1 + quadrant.y * static_cast<int>(row);
  const int edge = quadrant.x > 0 ? grid_.width() - 1 - eye.x : eye.x;
  const std::int64_t first = std::max<std::int64_t>(0, floor_div(view.low.dx * row, view.low.dy) + 1);
  const std::int64_t last = std::min<std::int64_t>(edge, ceil_div(view.high.dx * row, view.high.dy) - 1);
  if (first > last) return;
  const std::uint64_t* words = corners_.line(line);
  int a = eye.x + 1 + quadrant.x * static_cast<int>(first);
  int b = eye.x + 1 + quadrant.x * static_cast<int>(last);
  if (a > b) std::swap(a, b);
  for (int w = a >> 6; w <= b >> 6; ++w) {
    std::uint64_t bits = words[w];
    if (w == a >> 6) bits &= ~std::uint64_t{0} << (a & 63);
    if (w == b >> 6) bits &= ~std::uint64_t{0} >> (63 - (b & 63));
    for (; bits != 0; bits &= bits - 1) {
      const int bit = w << 6 | std::countr_zero(bits);
      const std::int64_t k = std::abs(bit - eye.x - 1);
      // The line enters the row half a cell before its centre; closed squares are touched on both sides of a border.
      const std::int64_t entry = ceil_div(k * (2 * row - 1) - row, 2 * row);
      const int other = eye.x + 1 + quadrant.x * static_cast<int>(entry);
      if (grid_.rows().all(line, std::min(bit, other), std::max(bit, other)))
        seen.push_back({bit - 1, eye.y + quadrant.y * static_cast<int>(row)});
    }
  }
}

/// What of a view goes on beyond the row.
void CornerSight::narrow(Cell eye, Quadrant quadrant, std::int64_t row, const Interval& view) {
  const int line = eye.y + 1 + quadrant.y * static_cast<int>(row);
  const int edge = quadrant.x > 0 ? grid_.width() - eye.x : eye.x + 1;  // the border: blocked
  Slope low = view.low;
  std::int64_t k = std::max<std::int64_t>(0, floor_div(low.dx * (2 * row - 1) - low.dy, 2 * low.dy));
  while (k <= edge) {
    const int bit = eye.x + 1 + quadrant.x * static_cast<int>(k);
    if (!blocked_.test(line, bit)) {
      k += distance_to(blocked_, line, bit, quadrant.x);
      continue;
    }
    // A run of blocked cells takes away all slopes that touch it anywhere in the row.
    const Slope begin = k == 0 ? Slope{-1, 1} : Slope{2 * k - 1, 2 * row + 1};
    if (!(begin < view.high)) break;
    if (low < begin) next_.push_back({low, begin});
    const std::int64_t end = quadrant.x > 0 ? grid_.rows().next(line, bit, grid_.width()) - eye.x - 2
                                            : eye.x - grid_.rows().previous(line, bit, 1);
    if (end >= edge) return;
    const Slope after{2 * end + 1, 2 * row - 1};
    if (low < after) low = after;
    if (!(low < view.high)) return;
    k = end + 1;
  }
  if (low < view.high) next_.push_back({low, view.high});
}

}  // namespace concord
