#include "core/polygon.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <string>

namespace concord {
namespace {

__extension__ using Wide = __int128;

/// 2^-32 m: products of two differences then stay far inside 128 bits.
constexpr double kQuantum = 1.0 / 4294967296.0;
/// A polygon thinner than this, about 4 nm, has no area.
constexpr std::int64_t kThinnest = 16;

struct Corner {
  std::int64_t x, y;
  std::uint32_t position;  ///< in the list of points
};

bool same_place(const Corner& a, const Corner& b) { return a.x == b.x && a.y == b.y; }

/// 1: a, b, c turn left; -1: right; 0: they lie on one line.
int turn(const Corner& a, const Corner& b, const Corner& c) {
  const Wide cross = Wide{b.x - a.x} * (c.y - a.y) - Wide{b.y - a.y} * (c.x - a.x);
  return (cross > 0) - (cross < 0);
}

bool turns_back(const Corner& a, const Corner& b, const Corner& c) {
  return turn(a, b, c) == 0 && Wide{b.x - a.x} * (c.x - b.x) + Wide{b.y - a.y} * (c.y - b.y) < 0;
}

/// Whether two closed segments have a point in common.
bool touch(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
  const auto apart = [](std::int64_t a0, std::int64_t a1, std::int64_t b0, std::int64_t b1) {
    return std::max(a0, a1) < std::min(b0, b1) || std::max(b0, b1) < std::min(a0, a1);
  };
  if (apart(a.x, b.x, c.x, d.x) || apart(a.y, b.y, c.y, d.y)) return false;
  return turn(a, b, c) * turn(a, b, d) <= 0 && turn(c, d, a) * turn(c, d, b) <= 0;
}

bool is_simple(const std::vector<Corner>& polygon) {
  const std::size_t n = polygon.size();
  const auto at = [&](std::size_t i) -> const Corner& { return polygon[i % n]; };
  for (std::size_t i = 0; i < n; ++i) {
    if (turns_back(at(i), at(i + 1), at(i + 2))) return false;
    for (std::size_t j = i + 2; j < n; ++j) {
      const bool neighbours = i == 0 && j + 1 == n;
      if (!neighbours && touch(at(i), at(i + 1), at(j), at(j + 1))) return false;
    }
  }
  return true;
}

std::int64_t extent_of(const std::vector<Corner>& polygon) {
  const auto [x0, x1] = std::ranges::minmax_element(polygon, {}, &Corner::x);
  const auto [y0, y1] = std::ranges::minmax_element(polygon, {}, &Corner::y);
  return std::max(x1->x - x0->x, y1->y - y0->y);
}

Wide twice_the_area(const std::vector<Corner>& polygon) {
  Wide sum = 0;
  const Corner& a = polygon.front();
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Corner &b = polygon[i], &c = polygon[i + 1];
    sum += Wide{b.x - a.x} * (c.y - a.y) - Wide{b.y - a.y} * (c.x - a.x);
  }
  return sum;
}

/// Whether the triangle before, tip, after holds no other corner, its boundary included.
bool is_ear(const std::vector<Corner>& polygon, const Corner& before, const Corner& tip, const Corner& after) {
  const auto [x0, x1] = std::minmax({before.x, tip.x, after.x});
  const auto [y0, y1] = std::minmax({before.y, tip.y, after.y});
  for (const Corner& p : polygon) {
    if (p.x < x0 || p.x > x1 || p.y < y0 || p.y > y1) continue;
    if (p.position == before.position || p.position == tip.position || p.position == after.position) continue;
    if (turn(before, tip, p) >= 0 && turn(tip, after, p) >= 0 && turn(after, before, p) >= 0) return false;
  }
  return true;
}

/// @pre simple, counterclockwise. Such a polygon has an ear once corners on a straight line are left out.
std::vector<Triangle> clip_ears(std::vector<Corner> polygon) {
  std::vector<Triangle> triangles;
  std::size_t i = 0;
  for (std::size_t tried = 0; polygon.size() > 2 && tried <= polygon.size(); ++tried) {
    const std::size_t n = polygon.size();
    i %= n;
    const Corner before = polygon[(i + n - 1) % n], tip = polygon[i], after = polygon[(i + 1) % n];
    const int bend = turn(before, tip, after);
    const bool ear = bend > 0 && is_ear(polygon, before, tip, after);
    if (ear) triangles.push_back({before.position, tip.position, after.position});
    if (ear || bend == 0) {
      polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(i));
      tried = 0;
    }
    ++i;  // not the next corner: triangles stay compact
  }
  assert(polygon.size() <= 2);
  return triangles;
}

std::optional<Error> fault_of(std::span<const Eigen::Vector2d> points) {
  if (points.size() > kMaxShapePoints) {
    return Error{Code::kTooLarge, "a polygon has at most " + std::to_string(kMaxShapePoints) + " points; simplify it"};
  }
  for (const Eigen::Vector2d& p : points) {
    if (!p.allFinite()) return Error{Code::kNotFinite, "a point of the polygon is not finite"};
    if (p.cwiseAbs().maxCoeff() > kFarthest) {
      return Error{Code::kOutOfBounds, "a point of the polygon is beyond the map; is it in metres?"};
    }
  }
  return std::nullopt;
}

std::vector<Corner> corners_of(std::span<const Eigen::Vector2d> points) {
  std::vector<Corner> corners;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Corner corner{std::llround(points[i].x() / kQuantum), std::llround(points[i].y() / kQuantum), i};
    if (corners.empty() || !same_place(corners.back(), corner)) corners.push_back(corner);
  }
  while (corners.size() > 1 && same_place(corners.back(), corners.front())) corners.pop_back();
  return corners;
}

}  // namespace

Result<std::vector<Triangle>> triangulate(std::span<const Eigen::Vector2d> points) {
  if (auto fault = fault_of(points)) return tl::unexpected(std::move(*fault));
  std::vector<Corner> corners = corners_of(points);
  if (corners.size() < 3) return refuse(Code::kBadShape, "a polygon needs at least 3 distinct points");
  const Wide area = twice_the_area(corners);
  if ((area < 0 ? -area : area) < Wide{extent_of(corners)} * kThinnest)
    return refuse(Code::kBadShape, "the polygon has no area; draw it around something");
  if (!is_simple(corners)) return refuse(Code::kBadShape, "the polygon crosses or touches itself; draw it in parts");
  if (area < 0) std::reverse(corners.begin(), corners.end());
  return clip_ears(std::move(corners));
}

bool encloses(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& p, double margin) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d &a = polygon[j], &b = polygon[i];
    const Eigen::Vector2d edge = b - a;
    const double length2 = edge.squaredNorm();
    const double share = length2 > 0 ? std::clamp((p - a).dot(edge) / length2, 0.0, 1.0) : 0.0;
    if ((a + share * edge - p).squaredNorm() <= margin * margin) return true;
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / edge.y() * edge.x()) inside = !inside;
  }
  return inside;
}

}  // namespace concord
