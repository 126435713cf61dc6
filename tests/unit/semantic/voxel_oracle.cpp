#include "voxel_oracle.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <boost/multiprecision/cpp_int.hpp>

namespace concord {
namespace {

using Number = boost::multiprecision::cpp_rational;
using Whole = boost::multiprecision::cpp_int;
using Point = std::array<Number, 3>;

/// What of a convex polygon lies on one side of a plane across an axis, the plane included.
std::vector<Point> cut(const std::vector<Point>& polygon, int axis, const Number& at, bool keep_above) {
  std::vector<Point> out;
  const auto kept = [&](const Point& p) { return keep_above ? p[axis] >= at : p[axis] <= at; };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if (kept(a)) out.push_back(a);
    if (kept(a) == kept(b)) continue;
    const Number share = (at - a[axis]) / (b[axis] - a[axis]);
    Point p;
    for (int k = 0; k < 3; ++k) p[k] = a[k] + share * (b[k] - a[k]);
    p[axis] = at;
    out.push_back(p);
  }
  return out;
}

/// Convex, so that the mean of points that each leave one upper side leaves them all.
bool holds_a_point_of(VoxelIndex voxel, std::vector<Point> polygon) {
  const std::array<std::int32_t, 3> low{voxel.x, voxel.y, voxel.z};
  for (int axis = 0; axis < 3; ++axis) {
    polygon = cut(polygon, axis, Number(low[axis]), true);
    polygon = cut(polygon, axis, Number(low[axis] + 1), false);
  }
  if (polygon.empty()) return false;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::ranges::all_of(polygon, [&](const Point& p) { return p[axis] >= low[axis] + 1; })) return false;
  }
  return true;
}

std::int32_t floor_of(std::int64_t snapped) {
  return static_cast<std::int32_t>(snapped >= 0 ? snapped / kSnap : -((-snapped + kSnap - 1) / kSnap));
}

std::array<Snapped, 3> corners(const SnappedMesh& mesh, std::size_t i) {
  const auto& t = mesh.triangles[i];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

/// Six times the volume of the corner a, b, c, d: on which side of the plane a, b, c the point d lies.
Whole side(const std::array<Whole, 3>& a, const std::array<Whole, 3>& b, const std::array<Whole, 3>& c,
           const std::array<Whole, 3>& d) {
  std::array<Whole, 3> u, v, w;
  for (int k = 0; k < 3; ++k) u[k] = b[k] - a[k], v[k] = c[k] - a[k], w[k] = d[k] - a[k];
  return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

/// Whether the line piece from p to q crosses a triangle; nothing if it only touches it.
std::optional<bool> crosses(const std::array<Whole, 3>& p, const std::array<Whole, 3>& q,
                            const std::array<std::array<Whole, 3>, 3>& t) {
  const int a = side(t[0], t[1], t[2], p).sign(), b = side(t[0], t[1], t[2], q).sign();
  if (a == 0 && b == 0) return std::nullopt;
  if (a * b > 0) return false;
  const int s0 = side(p, q, t[0], t[1]).sign(), s1 = side(p, q, t[1], t[2]).sign(), s2 = side(p, q, t[2], t[0]).sign();
  const bool within = (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
  if (!within) return false;
  if (s0 == 0 || s1 == 0 || s2 == 0 || a == 0 || b == 0) return std::nullopt;
  return true;
}

}  // namespace

std::set<VoxelIndex> surface_oracle(const SnappedMesh& mesh) {
  std::set<VoxelIndex> out;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    std::vector<Point> polygon;
    std::array<std::int32_t, 3> low{}, high{};
    for (const Snapped& corner : corners(mesh, i)) {
      Point p;
      for (int k = 0; k < 3; ++k) {
        p[k] = Number(Whole(corner[k]), Whole(kSnap));
        const std::int32_t cell = floor_of(corner[k]);
        low[k] = polygon.empty() ? cell : std::min(low[k], cell);
        high[k] = polygon.empty() ? cell : std::max(high[k], cell);
      }
      polygon.push_back(p);
    }
    for (std::int32_t x = low[0]; x <= high[0]; ++x) {
      for (std::int32_t y = low[1]; y <= high[1]; ++y) {
        for (std::int32_t z = low[2]; z <= high[2]; ++z) {
          if (!out.contains({x, y, z}) && holds_a_point_of({x, y, z}, polygon)) out.insert({x, y, z});
        }
      }
    }
  }
  return out;
}

bool inside_oracle(const SnappedMesh& mesh, VoxelIndex voxel) {
  const auto centre = [](std::int32_t c) { return Whole(c) * kSnap + kSnap / 2; };
  const std::array<Whole, 3> p{centre(voxel.x), centre(voxel.y), centre(voxel.z)};
  for (int attempt = 0;; ++attempt) {
    const std::array<Whole, 3> q{p[0] + 1'000'003LL * kSnap, p[1] + (7919LL + attempt) * kSnap,
                                 p[2] + (104'729LL + 3 * attempt) * kSnap};
    bool odd = false, clear = true;
    for (std::size_t i = 0; i < mesh.triangles.size() && clear; ++i) {
      std::array<std::array<Whole, 3>, 3> t;
      const auto c = corners(mesh, i);
      for (int k = 0; k < 9; ++k) t[k / 3][k % 3] = c[k / 3][k % 3];
      const auto crossed = crosses(p, q, t);
      // Without area there is nothing to cross; the edges of others are met elsewhere.
      const bool flat = side(t[0], t[1], t[2], p) == 0 && side(t[0], t[1], t[2], {p[0] + 1, p[1] + 2, p[2] + 5}) == 0;
      if (flat) continue;
      if (!crossed) clear = false;
      if (crossed && *crossed) odd = !odd;
    }
    if (clear) return odd;
  }
}

}  // namespace concord
