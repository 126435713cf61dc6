#include "planner/footprint/hull_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace concord {
namespace {

double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Rows of cells that a hull covers, each from its leftmost point there to its rightmost.
class Rows {
 public:
  Rows(int first, int last, double slack) : first_(first), last_(last), slack_(slack) {
    for (int i = 0; i <= last - first; ++i) extents_[static_cast<std::size_t>(i)] = {1e300, -1e300};
  }

  void add(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    const auto& [low, high] = std::minmax(a, b, [](const auto& p, const auto& q) { return p.y() < q.y(); });
    const double slope = high.y() > low.y() ? (high.x() - low.x()) / (high.y() - low.y()) : 0;
    const int from = std::max(first_, static_cast<int>(std::floor(low.y() - slack_)) - 1);
    const int to = std::min(last_, static_cast<int>(std::floor(high.y() + slack_)) + 1);
    for (int y = from; y <= to; ++y) {
      // What comes into the row once everything is moved by up to slack lies that much beyond it now.
      const double bottom = y - slack_, top = y + 1 + slack_;
      if (high.y() < bottom || low.y() > top) continue;
      const double x0 = low.y() >= bottom ? low.x() : low.x() + slope * (bottom - low.y());
      const double x1 = high.y() <= top ? high.x() : low.x() + slope * (top - low.y());
      Extent& extent = extents_[static_cast<std::size_t>(y - first_)];
      extent = {std::min({extent.left, x0, x1}), std::max({extent.right, x0, x1})};
    }
  }

  [[nodiscard]] bool are_open(const OpenGrid& grid) const {
    for (int y = first_; y <= last_; ++y) {
      const Extent& extent = extents_[static_cast<std::size_t>(y - first_)];
      const double left = extent.left - slack_ + kFootprintTouch;
      const double right = extent.right + slack_ - kFootprintTouch;
      if (left >= right) continue;
      if (left < 0 || right > grid.width()) return false;
      const int from = static_cast<int>(left);
      const int to = static_cast<int>(std::ceil(right)) - 1;
      if (!grid.rows().all(y + 1, from + 1, to + 1)) return false;
    }
    return true;
  }

 private:
  struct Extent {
    double left, right;
  };

  int first_, last_;
  double slack_;
  std::array<Extent, kMaxHullRows> extents_;
};

}  // namespace

std::vector<Eigen::Vector2d> convex_hull(std::span<const Eigen::Vector2d> points) {
  std::vector<Eigen::Vector2d> sorted(points.begin(), points.end());
  std::sort(sorted.begin(), sorted.end(),
            [](const auto& a, const auto& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  std::vector<Eigen::Vector2d> hull;
  const auto go = [&](auto begin, auto end) {
    const std::size_t base = hull.size();
    for (auto p = begin; p != end; ++p) {
      while (hull.size() >= base + 2 && turn(hull[hull.size() - 2], hull.back(), *p) <= 0) hull.pop_back();
      hull.push_back(*p);
    }
    hull.pop_back();
  };
  go(sorted.begin(), sorted.end());
  go(sorted.rbegin(), sorted.rend());
  return hull;
}

bool covers_open_cells(const OpenGrid& grid, std::span<const Eigen::Vector2d> points, double slack) {
  double low = 1e300, high = -1e300;
  for (const Eigen::Vector2d& p : points) {
    low = std::min(low, p.y());
    high = std::max(high, p.y());
  }
  low += kFootprintTouch - slack;
  high -= kFootprintTouch - slack;
  if (!(low >= 0 && high <= grid.height() && high - low < kMaxHullRows - 2)) return false;
  Rows rows(static_cast<int>(low), static_cast<int>(std::ceil(high)) - 1, slack);
  const std::vector<Eigen::Vector2d> hull = convex_hull(points);
  for (std::size_t i = 0; i < hull.size(); ++i) rows.add(hull[i], hull[(i + 1) % hull.size()]);
  return rows.are_open(grid);
}

}  // namespace concord
