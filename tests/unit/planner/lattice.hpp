#pragma once

#include <cmath>
#include <optional>
#include <queue>
#include <random>
#include <vector>

#include "planner/lattice/open_grid.hpp"

namespace concord::test {

/// A rectangle of cells as plain as can be: what the bitmaps are held against.
struct Plain {
  int width, height;
  std::vector<bool> open;

  [[nodiscard]] bool at(int x, int y) const {
    return x >= 0 && y >= 0 && x < width && y < height && open[static_cast<std::size_t>(y) * width + x];
  }
  void set(int x, int y, bool value) { open[static_cast<std::size_t>(y) * width + x] = value; }
  [[nodiscard]] bool can_step(Cell from, Cell to) const {
    return at(to.x, to.y) && at(from.x, to.y) && at(to.x, from.y);
  }
};

inline Plain all_open(int width, int height) {
  return {width, height, std::vector<bool>(static_cast<std::size_t>(width) * height, true)};
}

/// Specks, boxes and walls with doors, as much of each as chance will have it.
inline Plain random_plain(std::mt19937& random, int most_side) {
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  Plain plain = all_open(1 + below(most_side), 1 + below(most_side));
  const int specks = below(3) == 0 ? plain.width * plain.height * below(40) / 100 : below(12);
  for (int i = 0; i < specks; ++i) plain.set(below(plain.width), below(plain.height), false);
  for (int i = below(8); i > 0; --i) {
    const int x0 = below(plain.width), y0 = below(plain.height), w = 1 + below(12), h = 1 + below(12);
    for (int y = y0; y < std::min(y0 + h, plain.height); ++y)
      for (int x = x0; x < std::min(x0 + w, plain.width); ++x) plain.set(x, y, false);
  }
  for (int i = below(5); i > 0; --i) {
    const bool upright = below(2) == 0;
    const int at = below(upright ? plain.width : plain.height);
    const int length = upright ? plain.height : plain.width;
    const int door = below(length);
    for (int k = 0; k < length; ++k) {
      if (std::abs(k - door) > 1) upright ? plain.set(at, k, false) : plain.set(k, at, false);
    }
  }
  return plain;
}

inline Cell random_open(std::mt19937& random, const Plain& plain) {
  for (int tries = 0; tries < 1000; ++tries) {
    const Cell cell{static_cast<int>(random() % plain.width), static_cast<int>(random() % plain.height)};
    if (plain.at(cell.x, cell.y)) return cell;
  }
  return {0, 0};
}

inline OpenGrid to_grid(const Plain& plain) {
  OpenGrid grid(plain.width, plain.height);
  for (int y = 0; y < plain.height; ++y)
    for (int x = 0; x < plain.width; ++x) grid.set({x, y}, plain.at(x, y));
  return grid;
}

/// Changes some cells of a small rectangle in both, anywhere or with a corner at `at`. Returns where.
inline Window random_change(std::mt19937& random, Plain& plain, OpenGrid& grid, std::optional<Cell> at = {}) {
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  Window window{at.value_or(Cell{below(plain.width), below(plain.height)}), {}};
  window.high = {std::min(window.low.x + below(9), plain.width - 1),
                 std::min(window.low.y + below(9), plain.height - 1)};
  const int kind = below(3);
  for (int y = window.low.y; y <= window.high.y; ++y) {
    for (int x = window.low.x; x <= window.high.x; ++x) {
      const bool open = kind == 0 || (kind == 2 && below(2) == 0);
      plain.set(x, y, open);
      grid.set({x, y}, open);
    }
  }
  return window;
}

/// Shortest lengths from `from` to all cells over eight directions, by Dijkstra's search; infinity where there is no
/// way.
inline std::vector<double> dijkstra(const Plain& plain, Cell from) {
  std::vector<double> best(plain.open.size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, Cell>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto reach = [&](Cell cell, double length) {
    double& known = best[static_cast<std::size_t>(cell.y) * plain.width + cell.x];
    if (length >= known) return;
    known = length;
    queue.emplace(length, cell);
  };
  if (plain.at(from.x, from.y)) reach(from, 0);
  while (!queue.empty()) {
    const auto [length, cell] = queue.top();
    queue.pop();
    if (length > best[static_cast<std::size_t>(cell.y) * plain.width + cell.x]) continue;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Cell next{cell.x + dx, cell.y + dy};
        if (next != cell && plain.can_step(cell, next)) reach(next, length + std::hypot(dx, dy));
      }
    }
  }
  return best;
}

}  // namespace concord::test
