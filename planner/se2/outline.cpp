#include "planner/se2/outline.hpp"

namespace concord {
namespace {

double distance(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d d = b - a;
  const double along = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return (p - a - along * d).norm();
}

/// Whether the segment comes into the inside of a square.
bool enters(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& low,
            const Eigen::Vector2d& high) {
  double from = 0, to = 1;
  for (int axis = 0; axis < 2; ++axis) {
    const double d = b[axis] - a[axis];
    if (d == 0) {
      if (a[axis] <= low[axis] || a[axis] >= high[axis]) return false;
      continue;
    }
    const auto [first, last] = std::minmax({(low[axis] - a[axis]) / d, (high[axis] - a[axis]) / d});
    from = std::max(from, first);
    to = std::min(to, last);
  }
  return from < to;
}

}  // namespace

Outline::Outline(std::span<const Eigen::Vector2d> polygon, const Pose& pose, double resolution)
    : low_(Eigen::Vector2d::Constant(1e300)), high_(Eigen::Vector2d::Constant(-1e300)) {
  const Eigen::Vector2d ahead = pose.heading(), left(-ahead.y(), ahead.x());
  for (const Eigen::Vector2d& v : polygon) {
    corners_.push_back((pose.p + v.x() * ahead + v.y() * left) / resolution);
    low_ = low_.cwiseMin(corners_.back());
    high_ = high_.cwiseMax(corners_.back());
  }
}

bool Outline::holds(const Eigen::Vector2d& p) const {
  bool inside = false;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Eigen::Vector2d& a = corners_[i];
    const Eigen::Vector2d& b = corners_[(i + 1) % corners_.size()];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) * (b.x() - a.x()) / (b.y() - a.y()))
      inside = !inside;
  }
  return inside;
}

bool Outline::overlaps(Cell cell, double touch) const {
  const Eigen::Vector2d low(cell.x + touch, cell.y + touch);
  const Eigen::Vector2d high(cell.x + 1 - touch, cell.y + 1 - touch);
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    if (enters(corners_[i], corners_[(i + 1) % corners_.size()], low, high)) return true;
  }
  return holds((low + high) / 2);
}

double Outline::distance(Cell cell) const {
  if (overlaps(cell, 0)) return 0;
  const Eigen::Vector2d low(cell.x, cell.y);
  double least = 1e300;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Eigen::Vector2d& a = corners_[i];
    const Eigen::Vector2d& b = corners_[(i + 1) % corners_.size()];
    least = std::min(least, (a - a.cwiseMax(low).cwiseMin(low + Eigen::Vector2d(1, 1))).norm());
    for (const double x : {0.0, 1.0}) {
      for (const double y : {0.0, 1.0}) {
        least = std::min(least, concord::distance(low + Eigen::Vector2d(x, y), a, b));
      }
    }
  }
  return least;
}

}  // namespace concord
