#include "planner/footprint/footprint.hpp"

#include <algorithm>
#include <cmath>

#include "planner/footprint/triangles.hpp"

namespace concord {
namespace {

using Points = std::vector<Eigen::Vector2d>;

/// Positive where a, b, c turn left.
double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

const Eigen::Vector2d& next(const Points& polygon, std::size_t i) { return polygon[(i + 1) % polygon.size()]; }

double distance(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d d = b - a;
  const double along = d.squaredNorm() > 0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p - a - along * d).norm();
}

/// Whether two segments come nearer to each other than a micrometre.
bool meet(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, const Eigen::Vector2d& d) {
  constexpr double kTouch = 1e-6;
  if (std::min({distance(a, c, d), distance(b, c, d), distance(c, a, b), distance(d, a, b)}) < kTouch) return true;
  return turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
}

/// Whether no two edges meet but neighbours at their common corner.
bool is_simple(const Points& polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d& before = polygon[(i + n - 1) % n];
    // A spike, or a corner that is there twice.
    if (distance(next(polygon, i), before, polygon[i]) < 1e-6 || distance(before, polygon[i], next(polygon, i)) < 1e-6)
      return false;
    for (std::size_t k = i + 2; k < n; ++k) {
      if (i == 0 && k == n - 1) continue;
      if (meet(polygon[i], next(polygon, i), polygon[k], next(polygon, k))) return false;
    }
  }
  return true;
}

double area(const Points& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) twice += turn({0, 0}, polygon[i], next(polygon, i));
  return twice / 2;
}

bool holds_origin(const Points& polygon) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = next(polygon, i);
    if ((a.y() > 0) != (b.y() > 0) && a.x() - a.y() * (b.x() - a.x()) / (b.y() - a.y()) > 0) inside = !inside;
  }
  return inside;
}

bool is_convex(const Points& polygon) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (turn(polygon[i], next(polygon, i), next(polygon, (i + 1) % polygon.size())) < 0) return false;
  }
  return true;
}

}  // namespace

Result<Footprint> Footprint::make(std::vector<Eigen::Vector2d> polygon) {
  if (polygon.size() > kMaxVertices) {
    return refuse(Code::kTooLarge, "a footprint has at most " + std::to_string(kMaxVertices) + " corners");
  }
  if (polygon.size() < 3) return refuse(Code::kMalformed, "a footprint has at least three corners");
  for (const Eigen::Vector2d& p : polygon) {
    if (!p.allFinite()) return refuse(Code::kNotFinite, "a footprint's corners must be numbers");
    if (p.norm() > kMaxReach) return refuse(Code::kOutOfBounds, "a footprint reaches 10 m at most");
  }
  if (!is_simple(polygon)) return refuse(Code::kBadShape, "the footprint's outline touches or crosses itself");
  if (area(polygon) < 0) std::reverse(polygon.begin(), polygon.end());
  Footprint footprint;
  footprint.inscribed_ = kMaxReach;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    footprint.inscribed_ = std::min(footprint.inscribed_, distance({0, 0}, polygon[i], next(polygon, i)));
    footprint.circumscribed_ = std::max(footprint.circumscribed_, polygon[i].norm());
  }
  if (!holds_origin(polygon) || footprint.inscribed_ < kLeast) {
    return refuse(Code::kBadShape, "the footprint must hold its reference point (0, 0), a millimetre inside");
  }
  footprint.parts_ = is_convex(polygon) ? std::vector<Points>{polygon} : triangles(polygon);
  if (footprint.parts_.empty()) return refuse(Code::kBadShape, "the footprint's outline is too thin");
  footprint.polygon_ = std::move(polygon);
  return footprint;
}

Footprint Footprint::scaled(double factor) const {
  Footprint other = *this;
  for (Eigen::Vector2d& p : other.polygon_) p *= factor;
  for (Points& part : other.parts_) {
    for (Eigen::Vector2d& p : part) p *= factor;
  }
  other.inscribed_ *= factor;
  other.circumscribed_ *= factor;
  return other;
}

Result<Footprint> make_rectangle(double length, double width) {
  const double x = length / 2, y = width / 2;
  return Footprint::make({{-x, -y}, {x, -y}, {x, y}, {-x, y}});
}

}  // namespace concord
