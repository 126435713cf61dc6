#include "semantic/models/triangle_voxels.hpp"

#include <algorithm>

#include "semantic/models/exact_range.hpp"

namespace concord {
namespace {

struct Cells {
  Snapped low, high;  ///< voxels that the triangle's bounding box meets, both included
};

Cells cells_of(const std::array<Snapped, 3>& corners) {
  Cells cells{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
    cells.low[axis] = floor_div(low, kSnap);
    cells.high[axis] = floor_div(high, kSnap);
  }
  return cells;
}

/// A direction in the plane of two axes, and where a voxel must lie along it to meet the triangle:
/// low <= a i + b j <= high for the voxel with indices (i, j) on these axes.
struct Slab {
  std::int64_t a, b, low, high;

  /// The j for this i.
  [[nodiscard]] IntRange across(std::int64_t i) const { return solve<std::int64_t>(low, high, a * i, b); }
};

/// What the voxels' own extent adds to [low, high] of the triangle along the direction `d`: the voxel (i, ...) spans
/// d i kSnap + [sum of negative d, sum of positive d] kSnap, open wherever it leads to an upper side.
template <class Int>
void widen(Int d, Int& low, Int& high, bool& open_above, bool& open_below) {
  low -= d > 0 ? d * kSnap : 0;
  high -= d < 0 ? d * kSnap : 0;
  open_above = open_above || d > 0;
  open_below = open_below || d < 0;
}

/// In the plane of axes u and v, across the edge from p to q; r is the third corner.
Slab across_edge(const Snapped& p, const Snapped& q, const Snapped& r, int u, int v) {
  const std::int64_t a = p[v] - q[v], b = q[u] - p[u];
  const auto along = [&](const Snapped& c) { return Int128{a} * c[u] + Int128{b} * c[v]; };
  Int128 low = std::min(along(p), along(r)), high = std::max(along(p), along(r));
  bool open_above = false, open_below = false;
  widen<Int128>(a, low, high, open_above, open_below);
  widen<Int128>(b, low, high, open_above, open_below);
  return {a, b, static_cast<std::int64_t>(ceil_div<Int128>(low + (open_above ? 1 : 0), kSnap)),
          static_cast<std::int64_t>(floor_div<Int128>(high - (open_below ? 1 : 0), kSnap))};
}

std::array<Slab, 3> across_edges(const std::array<Snapped, 3>& c, int u, int v) {
  return {across_edge(c[0], c[1], c[2], u, v), across_edge(c[1], c[2], c[0], u, v),
          across_edge(c[2], c[0], c[1], u, v)};
}

/// The plane of the triangle, as a slab in all three axes.
struct Plane {
  std::array<Int128, 3> normal;
  Int128 low, high;
};

Plane plane_of(const std::array<Snapped, 3>& c) {
  const auto edge = [&](int corner, int axis) { return Int128{c[corner][axis] - c[0][axis]}; };
  Plane plane{};
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    plane.normal[axis] = edge(1, u) * edge(2, v) - edge(1, v) * edge(2, u);
  }
  Int128 at = 0;
  for (int axis = 0; axis < 3; ++axis) at += plane.normal[axis] * c[0][axis];
  plane.low = plane.high = at;
  bool open_above = false, open_below = false;
  for (const Int128 n : plane.normal) widen<Int128>(n, plane.low, plane.high, open_above, open_below);
  plane.low = ceil_div<Int128>(plane.low + (open_above ? 1 : 0), kSnap);
  plane.high = floor_div<Int128>(plane.high - (open_below ? 1 : 0), kSnap);
  return plane;
}

/// The axis that the plane is seen along best.
int steepest(const Plane& plane) {
  int best = 2;
  const auto size = [&](int axis) { return plane.normal[axis] < 0 ? -plane.normal[axis] : plane.normal[axis]; };
  for (const int axis : {0, 1}) {
    if (size(axis) > size(best)) best = axis;
  }
  return best;
}

IntRange across_all(const std::array<Slab, 3>& slabs, std::int64_t i) {
  return slabs[0].across(i) & slabs[1].across(i) & slabs[2].across(i);
}

/// Every voxel of the box: what a triangle meets that is one voxel wide but on one axis.
void add_all(const Cells& cells, BrickMasks& out) {
  for (std::int64_t x = cells.low[0]; x <= cells.high[0]; ++x) {
    for (std::int64_t y = cells.low[1]; y <= cells.high[1]; ++y) {
      out.insert_column(static_cast<std::int32_t>(x), static_cast<std::int32_t>(y),
                        static_cast<std::int32_t>(cells.low[2]), static_cast<std::int32_t>(cells.high[2]));
    }
  }
}

/// The columns that a triangle's bounding box spans, seen along the axis where they are most: what it may cost.
std::int64_t columns_of(const Cells& cells) {
  std::array<std::int64_t, 3> size{};
  for (int axis = 0; axis < 3; ++axis) size[axis] = cells.high[axis] - cells.low[axis] + 1;
  std::ranges::sort(size);
  return size[1] * size[2];
}

}  // namespace

void add_surface(const std::array<Snapped, 3>& corners, BrickMasks& out) {
  const Cells cells = cells_of(corners);
  int wide = 0;
  for (int axis = 0; axis < 3; ++axis) wide += cells.high[axis] > cells.low[axis] ? 1 : 0;
  if (wide <= 1) return add_all(cells, out);

  const Plane plane = plane_of(corners);
  const int w = steepest(plane), u = (w + 1) % 3, v = (w + 2) % 3;
  const auto uv = across_edges(corners, u, v), uw = across_edges(corners, u, w), vw = across_edges(corners, v, w);
  const IntRange all_v{cells.low[v], cells.high[v]}, all_w{cells.low[w], cells.high[w]};
  std::array<std::int32_t, 3> voxel{};
  for (std::int64_t i = cells.low[u]; i <= cells.high[u]; ++i) {
    const IntRange js = all_v & across_all(uv, i), row = all_w & across_all(uw, i);
    if (row.empty()) continue;
    voxel[u] = static_cast<std::int32_t>(i);
    for (std::int64_t j = js.first; j <= js.last; ++j) {
      IntRange ks = row & across_all(vw, j);
      if (ks.empty()) continue;
      ks = ks & solve<Int128>(plane.low, plane.high, plane.normal[u] * i + plane.normal[v] * j, plane.normal[w]);
      voxel[v] = static_cast<std::int32_t>(j);
      for (std::int64_t k = ks.first; k <= ks.last; ++k) {
        voxel[w] = static_cast<std::int32_t>(k);
        out.insert(VoxelIndex{voxel[0], voxel[1], voxel[2]});
      }
    }
  }
}

std::array<Snapped, 3> corners_of(const SnappedMesh& mesh, std::size_t triangle) {
  const auto& corners = mesh.triangles[triangle];
  return {mesh.vertices[corners[0]], mesh.vertices[corners[1]], mesh.vertices[corners[2]]};
}

Result<BrickMasks> surface_of(const SnappedMesh& mesh) {
  std::int64_t columns = 0;
  BrickMasks out;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::array<Snapped, 3> corners = corners_of(mesh, i);
    columns += columns_of(cells_of(corners));
    if (columns > kMaxModelColumns) {
      return refuse(Code::kTooLarge, "the model's triangles span too many voxels; is its unit right?");
    }
    add_surface(corners, out);
    if (out.brick_count() > kMaxModelBricks) {
      return refuse(Code::kTooLarge, "the model would fill over " + std::to_string(kMaxModelBricks) + " bricks");
    }
  }
  return out;
}

}  // namespace concord
