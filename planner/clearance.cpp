#include "planner/clearance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace concord {
namespace {

/// Here everything is in cells.
struct Segment {
  Eigen::Vector2d a, b;
};

struct Square {
  Eigen::Vector2d low;
  double side;
};

bool crosses(const Segment& s, const Square& q) {
  double enter = 0;
  double leave = 1;
  const Eigen::Vector2d d = s.b - s.a;
  for (int axis = 0; axis < 2; ++axis) {
    const double to_low = q.low[axis] - s.a[axis];
    const double to_high = to_low + q.side;
    if (d[axis] == 0) {
      if (to_low > 0 || to_high < 0) return false;
      continue;
    }
    const auto [first, last] = std::minmax({to_low / d[axis], to_high / d[axis]});
    enter = std::max(enter, first);
    leave = std::min(leave, last);
  }
  return enter <= leave;
}

double distance(const Eigen::Vector2d& p, const Square& q) {
  const Eigen::Vector2d nearest = p.cwiseMax(q.low).cwiseMin(q.low + Eigen::Vector2d::Constant(q.side));
  return (p - nearest).norm();
}

double distance(const Eigen::Vector2d& p, const Segment& s) {
  const Eigen::Vector2d d = s.b - s.a;
  const double squared = d.squaredNorm();
  const double along = squared > 0 ? std::clamp((p - s.a).dot(d) / squared, 0.0, 1.0) : 0.0;
  return (p - s.a - along * d).norm();
}

double distance(const Segment& s, const Square& q) {
  if (crosses(s, q)) return 0;
  double least = std::min(distance(s.a, q), distance(s.b, q));
  for (const double x : {0.0, q.side}) {
    for (const double y : {0.0, q.side}) least = std::min(least, distance(q.low + Eigen::Vector2d(x, y), s));
  }
  return least;
}

/// What a distance is taken to.
struct Blocked {
  const Terrain& terrain;
  Against against;

  [[nodiscard]] std::uint64_t plane(BrickIndex column) const {
    const Ground there = terrain.at(column);
    return ~(against == Against::kImpassable ? there.passable : there.touchable);
  }
};

/// The least of `least` and the distances from the segment to the blocked cells of one column of bricks.
double nearest_in(const Blocked& blocked, BrickIndex column, const Segment& s, double least) {
  const Eigen::Vector2d low(8.0 * column.x, 8.0 * column.y);
  if (distance(s, Square{low, 8}) >= least) return least;
  for (std::uint64_t bits = blocked.plane(column); bits != 0; bits &= bits - 1) {
    const int local = std::countr_zero(bits);
    least = std::min(least, distance(s, Square{low + Eigen::Vector2d(local & 7, local >> 3), 1}));
  }
  return least;
}

/// The part of the segment with y in [low, high]; where none has, its nearest end twice.
Segment slice(const Segment& s, double low, double high) {
  const double dy = s.b.y() - s.a.y();
  if (dy == 0) return s;
  const double at_low = std::clamp((low - s.a.y()) / dy, 0.0, 1.0);
  const double at_high = std::clamp((high - s.a.y()) / dy, 0.0, 1.0);
  return {s.a + at_low * (s.b - s.a), s.a + at_high * (s.b - s.a)};
}

std::int32_t brick_coordinate(double cells) { return static_cast<std::int32_t>(std::floor(cells / 8)); }

double nearest_along(const Blocked& blocked, const Segment& s, double least) {
  const double reach = least + 1e-6;
  const std::int32_t first = brick_coordinate(std::min(s.a.y(), s.b.y()) - reach);
  const std::int32_t last = brick_coordinate(std::max(s.a.y(), s.b.y()) + reach);
  for (std::int32_t y = first; y <= last && least > 0; ++y) {
    const Segment near = slice(s, 8.0 * y - reach, 8.0 * (y + 1) + reach);
    const std::int32_t left = brick_coordinate(std::min(near.a.x(), near.b.x()) - reach);
    const std::int32_t right = brick_coordinate(std::max(near.a.x(), near.b.x()) + reach);
    for (std::int32_t x = left; x <= right && least > 0; ++x) least = nearest_in(blocked, {x, y, 0}, s, least);
  }
  return least;
}

/// The distance to the nearest blocked cell if it is less than `reach`. Both in cells: a length that went to metres and
/// back is another number than before.
std::optional<double> nearest(const Blocked& blocked, std::span<const Eigen::Vector2d> points, double reach) {
  const double resolution = blocked.terrain.resolution();
  double least = reach;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d& next = points[std::min(i + 1, points.size() - 1)];
    least = nearest_along(blocked, {points[i] / resolution, next / resolution}, least);
  }
  return least < reach ? std::optional(least) : std::nullopt;
}

}  // namespace

std::optional<double> clearance(const Terrain& terrain, std::span<const Eigen::Vector2d> points, double reach,
                                Against against) {
  const std::optional<double> cells = nearest({terrain, against}, points, reach / terrain.resolution());
  return cells ? std::optional(*cells * terrain.resolution()) : std::nullopt;
}

bool is_clear(const Terrain& terrain, std::span<const Eigen::Vector2d> points, double radius) {
  constexpr double kLine = 5e-7;
  // Two millionths of a cell are left for rounding: the search allows one (kTouch).
  const double disc = std::max(radius / terrain.resolution() - 2e-6, kLine);
  if (nearest({terrain, Against::kUntouchable}, points, disc)) return false;
  return !terrain.has_contact() || !nearest({terrain, Against::kImpassable}, points, kLine);
}

}  // namespace concord
