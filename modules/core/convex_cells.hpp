#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/lattice.hpp"

namespace concord {

/// A convex part of a shape, in voxels: a point, segment, triangle, box or prism.
struct ConvexPiece {
  std::vector<Eigen::Vector3d> corners;
  std::vector<Eigen::Vector3d> edges;  ///< one for each direction in which an edge runs; any length
};

/// Whole numbers from first to last; none when last < first.
struct CellRange {
  double first, last;
};

/// The voxels that a convex piece reaches: the separating axis test (Gottschalk, Lin and Manocha, "OBBTree", 1996),
/// solved for whole columns at once. The piece widened by a voxel's own extent is an intersection of slabs, one for
/// each axis that may separate them, and the voxels are those whose centre lies in all. Work follows the voxels that
/// are found, not the box around them. An axis that rounding has turned a little never loses a voxel.
class ConvexCells {
 public:
  /// The voxels that are no further than `slack` voxels from the piece along every axis; below 0: that overlap it by at
  /// least so much along every axis. With a `radius` above 0 also every voxel whose centre is within that distance, and
  /// some more: the caller tells them apart.
  ConvexCells(const ConvexPiece& piece, double slack, double radius = 0);

  /// Keeps only what lies in the layer z = 0.
  void cut_to_ground();

  /// Whether all cells are within the lattice's bounds.
  [[nodiscard]] bool in_bounds() const;

  [[nodiscard]] CellRange x_range() const;
  /// Rows of the plane x in which there may be cells.
  [[nodiscard]] CellRange y_range(double x) const;
  /// The cells of one column. @pre y is in y_range(x).
  [[nodiscard]] CellRange z_range(double x, double y) const;
  [[nodiscard]] bool holds(VoxelIndex voxel) const;

 private:
  /// low <= axis . index <= high
  struct Slab {
    Eigen::Vector3d axis;
    double low, high;
  };
  void add(const ConvexPiece& piece, const Eigen::Vector3d& direction, double slack, double radius);

  std::vector<Slab> upright_;  ///< that do not bound z
  std::vector<Slab> tilted_;   ///< that do
};

/// Calls visit(x, y, first z, last z) for every column with cells, ascending, until it returns false or `work`, from
/// which every plane and row takes one, is used up; false then. @pre in_bounds().
template <class Visit>
bool visit_columns(const ConvexCells& cells, std::int64_t& work, Visit&& visit) {
  const CellRange planes = cells.x_range();
  for (double x = planes.first; x <= planes.last; ++x) {
    const CellRange rows = cells.y_range(x);
    if (--work < 0) return false;
    for (double y = rows.first; y <= rows.last; ++y) {
      if (--work < 0) return false;
      const CellRange column = cells.z_range(x, y);
      if (column.first > column.last) continue;
      if (!visit(static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), static_cast<std::int32_t>(column.first),
                 static_cast<std::int32_t>(column.last))) {
        return false;
      }
    }
  }
  return true;
}

/// Calls visit(x, first y, last y) for every row of the layer z = 0 with cells, likewise. @pre cut_to_ground() and
/// in_bounds().
template <class Visit>
bool visit_ground_rows(const ConvexCells& cells, std::int64_t& work, Visit&& visit) {
  const CellRange planes = cells.x_range();
  for (double x = planes.first; x <= planes.last; ++x) {
    if (--work < 0) return false;
    const CellRange row = cells.y_range(x);
    if (row.first > row.last) continue;
    if (!visit(static_cast<std::int32_t>(x), static_cast<std::int32_t>(row.first), static_cast<std::int32_t>(row.last)))
      return false;
  }
  return true;
}

}  // namespace concord
