#include "planner/lattice/distance_field.hpp"

#include <algorithm>
#include <cassert>

namespace concord {

DistanceField::DistanceField(const OpenGrid& grid, int reach) : grid_(grid), reach_(reach) {
  assert(reach >= 1 && reach <= kMaxReach);
  const std::size_t cells = static_cast<std::size_t>(grid.width()) * grid.height();
  heights_.resize(cells);
  squared_.resize(cells);
  from_.resize(static_cast<std::size_t>(grid.width()) + 2);
  column_.resize(static_cast<std::size_t>(grid.width()) + 2);
  update({{0, 0}, {grid.width() - 1, grid.height() - 1}});
}

void DistanceField::update(const Window& window) {
  const int x0 = std::max(window.low.x, 0);
  const int x1 = std::min(window.high.x, grid_.width() - 1);
  const int y0 = std::max(window.low.y - reach_, 0);
  const int y1 = std::min(window.high.y + reach_, grid_.height() - 1);
  if (x0 > x1 || y0 > y1) return;
  find_heights(x0, x1, y0, y1);
  for (int y = y0; y <= y1; ++y) find_row(y, std::max(x0 - reach_, 0), std::min(x1 + reach_, grid_.width() - 1));
}

/// Row by row over the columns, upwards and then downwards, beginning so far outside that nothing matters from there.
void DistanceField::find_heights(int x0, int x1, int y0, int y1) {
  const int first = std::max(y0 - reach_, 0);
  const int last = std::min(y1 + reach_, grid_.height() - 1);
  const auto width = static_cast<std::size_t>(x1 - x0 + 1);
  std::vector<std::uint8_t> run(width, static_cast<std::uint8_t>(first == 0 ? 0 : reach_));
  const auto grow = [&](int y) {
    for (std::size_t i = 0; i < width; ++i) {
      const bool open = grid_.rows().test(y + 1, x0 + static_cast<int>(i) + 1);
      run[i] = static_cast<std::uint8_t>(open ? std::min(run[i] + 1, reach_) : 0);
    }
  };
  for (int y = first; y <= y1; ++y) {
    grow(y);
    if (y >= y0) std::copy(run.begin(), run.end(), heights_.begin() + static_cast<std::ptrdiff_t>(index_of({x0, y})));
  }
  std::fill(run.begin(), run.end(), static_cast<std::uint8_t>(last == grid_.height() - 1 ? 0 : reach_));
  for (int y = last; y >= y0; --y) {
    grow(y);
    if (y > y1) continue;
    std::uint8_t* heights = heights_.data() + index_of({x0, y});
    for (std::size_t i = 0; i < width; ++i) heights[i] = std::min(heights[i], run[i]);
  }
}

/// Cells x0 to x1 of a row, from the heights within reach of them. The border counts as columns of height 0.
void DistanceField::find_row(int y, int x0, int x1) {
  const std::uint8_t* heights = heights_.data() + index_of({0, y});
  const int first = std::max(x0 - reach_, -1);
  const int last = std::min(x1 + reach_, grid_.width());
  const auto square_at = [&](int x) { return x < 0 || x >= grid_.width() ? 0 : int{heights[x]} * heights[x]; };
  const int limit = reach_ * reach_;
  int count = 0;
  for (int x = first; x <= last; ++x) {
    const int square = square_at(x);
    if (square >= limit) continue;
    while (count > 0) {
      const int other = column_[count - 1];
      // The first cell at which this parabola is not above the other.
      const int rise = square + x * x - square_at(other) - other * other;
      const int width = 2 * (x - other);
      const int begin = rise >= 0 ? (rise + width - 1) / width : -(-rise / width);
      if (begin > from_[count - 1]) {
        from_[count] = begin;
        break;
      }
      --count;
    }
    if (count == 0) from_[0] = first;
    column_[count++] = x;
  }
  std::uint16_t* squared = squared_.data() + index_of({0, y});
  int k = 0;
  for (int x = x0; x <= x1; ++x) {
    while (k + 1 < count && from_[k + 1] <= x) ++k;
    int least = limit;
    if (count > 0) {
      const int dx = x - column_[k];
      least = std::min(least, dx * dx + square_at(column_[k]));
    }
    squared[x] = static_cast<std::uint16_t>(least);
  }
}

}  // namespace concord
