#pragma once

#include <vector>

#include "core/convex_cells.hpp"
#include "core/shape.hpp"

namespace concord {

/// Cells of any size, the lowest corner of cell (0, 0, 0) at `origin`: metres of the map to cells.
struct CellFrame {
  Eigen::Vector3d origin, size;

  [[nodiscard]] Eigen::Vector3d point(const Eigen::Vector3d& p_map) const {
    return (p_map - origin).cwiseQuotient(size);
  }
  [[nodiscard]] Eigen::Vector3d direction(const Eigen::Vector3d& d_map) const { return d_map.cwiseQuotient(size); }
};

/// A polygon in space, cut along the plane through it. Refused: what `triangulate` refuses, and points farther than
/// kMaxOffPlane from the plane (kBadShape). @pre at least 3 points, finite.
[[nodiscard]] Result<std::vector<Triangle>> triangulate_area(const Area& area);

/// The convex parts of a shape, in cells; together they are the shape. Sides of a volume without thickness get a few
/// kOnFace of it, upwards. Refused: polygons that cannot be cut. @pre check(shape) but for those.
[[nodiscard]] std::vector<ConvexPiece> pieces_of(const Line& line, const Transform& T_map_frame,
                                                 const CellFrame& cells);
[[nodiscard]] Result<std::vector<ConvexPiece>> pieces_of(const Area& area, const Transform& T_map_frame,
                                                         const CellFrame& cells);
[[nodiscard]] Result<std::vector<ConvexPiece>> pieces_of(const Volume& volume, const Transform& T_map_frame,
                                                         const CellFrame& cells);

/// The volume as a box in a frame of its own, lowest corner at the origin; nullopt for a prism.
struct PlacedBox {
  Transform T_frame_corner;
  Eigen::Vector3d size;
};
[[nodiscard]] PlacedBox placed(const Box& box);
[[nodiscard]] PlacedBox placed(const OrientedBox& box);

}  // namespace concord
