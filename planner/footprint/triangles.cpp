#include "planner/footprint/triangles.hpp"

#include <algorithm>
#include <array>

namespace concord {
namespace {

double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

struct Corner {
  Eigen::Vector2d before, at, after;

  [[nodiscard]] bool holds(const Eigen::Vector2d& p) const {
    return turn(before, at, p) >= 0 && turn(at, after, p) >= 0 && turn(after, before, p) >= 0;
  }
};

Corner corner(const std::vector<Eigen::Vector2d>& polygon, std::size_t i) {
  const std::size_t n = polygon.size();
  return {polygon[(i + n - 1) % n], polygon[i], polygon[(i + 1) % n]};
}

/// Whether the corner can be cut off: it turns left, and no other corner lies in it.
bool is_ear(const std::vector<Eigen::Vector2d>& polygon, std::size_t i) {
  const Corner c = corner(polygon, i);
  if (turn(c.before, c.at, c.after) <= 0) return false;
  return std::none_of(polygon.begin(), polygon.end(), [&](const Eigen::Vector2d& p) {
    return p != c.before && p != c.at && p != c.after && c.holds(p);
  });
}

}  // namespace

std::vector<std::vector<Eigen::Vector2d>> triangles(std::vector<Eigen::Vector2d> polygon) {
  std::vector<std::vector<Eigen::Vector2d>> cut;
  while (polygon.size() >= 3) {
    std::size_t i = 0;
    // A corner on a straight line encloses nothing, and goes without a triangle.
    const auto is_flat = [&](std::size_t k) {
      const Corner c = corner(polygon, k);
      return turn(c.before, c.at, c.after) == 0;
    };
    while (i < polygon.size() && !is_flat(i) && !is_ear(polygon, i)) ++i;
    if (i == polygon.size()) return {};
    const Corner c = corner(polygon, i);
    if (!is_flat(i)) cut.push_back({c.before, c.at, c.after});
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return cut;
}

}  // namespace concord
