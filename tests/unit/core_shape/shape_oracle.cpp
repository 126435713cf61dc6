#include "shape_oracle.hpp"

#include <algorithm>

namespace concord::shape_oracle {
namespace {

/// What a solid of no height is thickened by, metres.
constexpr long double kFlat = 1e-12L;

long double cross(const FlatPoint& a, const FlatPoint& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Keeps what lies at sign * p[axis] <= bound (Sutherland and Hodgman).
std::vector<Point> clipped(const std::vector<Point>& polygon, int axis, long double sign, long double bound) {
  std::vector<Point> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const long double da = sign * a[axis] - bound, db = sign * b[axis] - bound;
    if (da <= 0) kept.push_back(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) kept.push_back(a + (b - a) * (da / (da - db)));
  }
  return kept;
}

bool lies_in(const FlatPoint& p, const std::vector<FlatPoint>& polygon) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const FlatPoint &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if ((a.y() <= p.y()) == (b.y() <= p.y())) continue;
    const long double x = a.x() + (p.y() - a.y()) * (b.x() - a.x()) / (b.y() - a.y());
    if (x > p.x()) inside = !inside;
  }
  return inside;
}

bool edges_cross(const FlatPoint& a, const FlatPoint& b, const FlatPoint& c, const FlatPoint& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) <= 0 && cross(d - c, a - c) * cross(d - c, b - c) <= 0 &&
         cross(b - a, d - c) != 0;
}

std::vector<FlatPoint> hull_of(std::vector<FlatPoint> points) {
  std::sort(points.begin(), points.end(),
            [](const auto& a, const auto& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
  std::vector<FlatPoint> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t start = hull.size();
    for (const FlatPoint& p : points) {
      while (hull.size() >= start + 2 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

/// What of a cell lies between two heights of the solid, seen from above.
std::vector<FlatPoint> shadow(const Cell& cell, const Solid& solid) {
  std::vector<Point> corners;
  for (int i = 0; i < 8; ++i) {
    const Point sign((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    corners.push_back(solid.T_map_solid.inverse() * Point(cell.centre + cell.half.cwiseProduct(sign)));
  }
  std::vector<FlatPoint> points;
  for (int i = 0; i < 8; ++i) {
    for (int bit = 1; bit < 8; bit *= 2) {
      if ((i & bit) != 0) continue;
      std::vector<Point> edge{corners[static_cast<std::size_t>(i)], corners[static_cast<std::size_t>(i | bit)]};
      edge = clipped(clipped(edge, 2, 1, solid.high + kFlat), 2, -1, kFlat - solid.low);
      for (const Point& p : edge) points.push_back(p.head<2>());
    }
  }
  return points;
}

}  // namespace

Cell cell_of(VoxelIndex voxel, double resolution, long double grown) {
  const Point centre(voxel.x + 0.5L, voxel.y + 0.5L, voxel.z + 0.5L);
  return {centre * static_cast<long double>(resolution), Point::Constant((0.5L + grown) * resolution)};
}

bool meets(std::vector<Point> polygon, const Cell& cell) {
  for (int axis = 0; axis < 3; ++axis) {
    polygon = clipped(polygon, axis, 1, cell.centre[axis] + cell.half[axis]);
    polygon = clipped(polygon, axis, -1, cell.half[axis] - cell.centre[axis]);
  }
  return !polygon.empty();
}

bool meets(const Solid& solid, const Cell& cell) {
  const std::vector<FlatPoint> points = shadow(cell, solid);
  if (points.size() < 3) return false;
  const std::vector<FlatPoint> hull = hull_of(points);
  if (hull.size() < 3) return false;
  if (lies_in(hull.front(), solid.points) || lies_in(solid.points.front(), hull)) return true;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    for (std::size_t j = 0; j < solid.points.size(); ++j) {
      if (edges_cross(hull[i], hull[(i + 1) % hull.size()], solid.points[j],
                      solid.points[(j + 1) % solid.points.size()])) {
        return true;
      }
    }
  }
  return false;
}

long double distance(const Point& p, const Point& a, const Point& b) {
  const Point edge = b - a;
  if (edge.norm() == 0) return (p - a).norm();
  const long double along = (p - a).dot(edge) / edge.norm();
  if (along <= 0) return (p - a).norm();
  if (along >= edge.norm()) return (p - b).norm();
  return (p - a).cross(edge).norm() / edge.norm();
}

long double distance(const Point& p, const Point& a, const Point& b, const Point& c) {
  const long double rim = std::min({distance(p, a, b), distance(p, b, c), distance(p, c, a)});
  Eigen::Matrix<long double, 3, 3> axes;
  axes << b - a, c - a, (b - a).cross(c - a);
  const Point share = axes.inverse() * (p - a);
  const bool above = share.x() >= 0 && share.y() >= 0 && share.x() + share.y() <= 1;
  return above ? std::abs(share.z()) * axes.col(2).norm() : rim;
}

}  // namespace concord::shape_oracle
