#include "core/convex_cells.hpp"

#include <algorithm>
#include <limits>

#include <Eigen/Geometry>

namespace concord {
namespace {

/// Directions shorter than this (voxels, or voxels squared) come from edges that are parallel as far as anybody can
/// tell: leaving them out moves the piece's boundary by less.
constexpr double kNoDirection = 1e-9;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr CellRange kAll{-kInfinity, kInfinity};
constexpr CellRange kNone{kInfinity, -kInfinity};

/// Keeps of `range` (of real numbers) what satisfies low <= factor t <= high.
void narrow(CellRange& range, double factor, double low, double high) {
  if (factor == 0) {
    if (low > 0 || high < 0) range = kNone;
    return;
  }
  const double a = low / factor, b = high / factor;
  range.first = std::max(range.first, std::min(a, b));
  range.last = std::min(range.last, std::max(a, b));
}

CellRange whole(const CellRange& range) { return {std::ceil(range.first), std::floor(range.last)}; }

}  // namespace

ConvexCells::ConvexCells(const ConvexPiece& piece, double slack, double radius) {
  const Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  for (int i = 0; i < 3; ++i) add(piece, axes.col(i), slack, radius);
  for (std::size_t e = 0; e < piece.edges.size(); ++e) {
    for (int i = 0; i < 3; ++i) add(piece, axes.col(i).cross(piece.edges[e]), slack, radius);
    for (std::size_t f = e + 1; f < piece.edges.size(); ++f) {
      add(piece, piece.edges[e].cross(piece.edges[f]), slack, radius);
    }
  }
}

void ConvexCells::add(const ConvexPiece& piece, const Eigen::Vector3d& direction, double slack, double radius) {
  const double length = direction.norm();
  if (!(length > kNoDirection)) return;
  const Eigen::Vector3d axis = direction / length;
  double low = kInfinity, high = -kInfinity;
  for (const Eigen::Vector3d& corner : piece.corners) {
    low = std::min(low, axis.dot(corner));
    high = std::max(high, axis.dot(corner));
  }
  // A voxel reaches half its extent beyond its centre, and its centre lies half a voxel beyond its index.
  const double reach = std::max(0.5 * axis.lpNorm<1>(), radius) + slack;
  const double to_centre = 0.5 * axis.sum();
  (axis.z() == 0 ? upright_ : tilted_).push_back({axis, low - reach - to_centre, high + reach - to_centre});
}

void ConvexCells::cut_to_ground() {
  for (Slab& slab : tilted_) {
    slab.axis.z() = 0;
    upright_.push_back(slab);
  }
  tilted_ = {{Eigen::Vector3d::UnitZ(), 0, 0}};
}

bool ConvexCells::in_bounds() const {
  // The lattice's own axes come first: x and y among the upright slabs, z among the tilted.
  // What overflowed is in no order.
  const auto ok = [](const Slab& slab) {
    return slab.low <= slab.high && std::ceil(slab.low) >= -kMaxVoxel && std::floor(slab.high) < kMaxVoxel;
  };
  return ok(upright_[0]) && ok(upright_[1]) && ok(tilted_[0]);
}

CellRange ConvexCells::x_range() const { return whole({upright_[0].low, upright_[0].high}); }

CellRange ConvexCells::y_range(double x) const {
  CellRange range = kAll;
  for (const Slab& slab : upright_) {
    const double offset = slab.axis.x() * x;
    narrow(range, slab.axis.y(), slab.low - offset, slab.high - offset);
  }
  return whole(range);
}

CellRange ConvexCells::z_range(double x, double y) const {
  CellRange range = kAll;
  for (const Slab& slab : tilted_) {
    const double offset = slab.axis.x() * x + slab.axis.y() * y;
    narrow(range, slab.axis.z(), slab.low - offset, slab.high - offset);
  }
  return whole(range);
}

bool ConvexCells::holds(VoxelIndex voxel) const {
  const Eigen::Vector3d index(voxel.x, voxel.y, voxel.z);
  const auto within = [&](const Slab& slab) {
    const double at = slab.axis.dot(index);
    return slab.low <= at && at <= slab.high;
  };
  return std::ranges::all_of(upright_, within) && std::ranges::all_of(tilted_, within);
}

}  // namespace concord
