#include "planner/route.hpp"

#include <algorithm>
#include <cmath>

namespace concord {
namespace {

using Points = std::vector<Eigen::Vector2d>;

std::int64_t cost_of(double cells) { return std::llround(cells * static_cast<double>(kStraight)); }

/// The furthest of `points` that can be seen from `from`, as far as doubling and then halving of the step tells.
std::size_t furthest_seen(FreeSpace& space, const Points& points, std::size_t from) {
  const auto seen = [&](std::size_t to) { return space.sees(points[from], points[to]); };
  const std::size_t last = points.size() - 1;
  std::size_t good = from + 1;  // each point sees the next: that is how they were found
  std::size_t step = 1;
  while (good < last && seen(std::min(good + step, last))) {
    good = std::min(good + step, last);
    step *= 2;
  }
  for (step /= 2; step > 0; step /= 2) {
    if (good + step <= last && seen(good + step)) good += step;
  }
  return good;
}

}  // namespace

Cell cell_of(const Eigen::Vector2d& p_cells) {
  return {static_cast<std::int32_t>(std::floor(p_cells.x())), static_cast<std::int32_t>(std::floor(p_cells.y()))};
}

Eigen::Vector2d centre_of(Cell cell) { return {cell.x + 0.5, cell.y + 0.5}; }

std::vector<Anchor> anchors(FreeSpace& space, const Eigen::Vector2d& p) {
  const Cell own = cell_of(p);
  const auto serves = [&](int dx, int dy) {
    const Cell cell{own.x + dx, own.y + dy};
    return space.is_open(cell) && space.sees(p, centre_of(cell));
  };
  std::vector<Anchor> found;
  const bool own_serves = serves(0, 0);
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const Cell cell{own.x + dx, own.y + dy};
      const bool is_own = dx == 0 && dy == 0;
      const bool is_one_step =
          !is_own && own_serves && space.is_open({cell.x, own.y}) && space.is_open({own.x, cell.y});
      if (is_one_step || !serves(dx, dy)) continue;
      found.push_back({cell, cost_of((centre_of(cell) - p).norm())});
    }
  }
  return found;
}

Points shorten(FreeSpace& space, const Points& points) {
  Points path{points.front()};
  for (std::size_t i = 0; i + 1 < points.size(); path.push_back(points[i])) i = furthest_seen(space, points, i);
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 1; i + 1 < path.size();) {
      if (!space.sees(path[i - 1], path[i + 1])) {
        ++i;
        continue;
      }
      path.erase(path.begin() + static_cast<std::ptrdiff_t>(i));
      changed = true;
    }
  }
  return path;
}

}  // namespace concord
