#include "core/shape_pieces.hpp"

#include <array>
#include <utility>

namespace concord {
namespace {

/// A side of a volume is made at least this thick, in cells: so that it shares volume by more than kOnFace with the
/// layer that it runs through.
constexpr double kThinnest = 4 * kOnFace;

/// An edge of a volume from `corner` on: thick enough, and when it had to be widened, upwards in the map.
Eigen::Vector3d thick_edge(const Eigen::Vector3d& unit, double length, Eigen::Vector3d& corner) {
  if ((unit * length).norm() >= kThinnest) return unit * length;
  Eigen::Index steepest = 0;
  unit.cwiseAbs().maxCoeff(&steepest);
  Eigen::Vector3d edge = unit.normalized() * kThinnest;
  if (edge[steepest] < 0) {
    corner += unit * length;
    edge = -edge;
  }
  return edge;
}

ConvexPiece piece_of(const PlacedBox& box, const Transform& T_map_frame, const CellFrame& cells) {
  const Transform T_map_corner = T_map_frame * box.T_frame_corner;
  Eigen::Vector3d corner = cells.point(T_map_corner.translation());
  ConvexPiece piece;
  for (int i = 0; i < 3; ++i) {
    piece.edges.push_back(thick_edge(cells.direction(T_map_corner.linear().col(i)), box.size[i], corner));
  }
  for (int i = 0; i < 8; ++i) {
    piece.corners.push_back(corner + (i & 1) * piece.edges[0] + (i >> 1 & 1) * piece.edges[1] +
                            (i >> 2) * piece.edges[2]);
  }
  return piece;
}

ConvexPiece flat_piece(const std::array<Eigen::Vector3d, 3>& corners) {
  return {{corners.begin(), corners.end()},
          {corners[1] - corners[0], corners[2] - corners[1], corners[0] - corners[2]}};
}

/// Newell's normal: as long as twice the area that the polygon covers.
Eigen::Vector3d normal_of(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    sum += (points[i] - points[0]).cross(points[i + 1] - points[0]);
  }
  return sum;
}

}  // namespace

Result<std::vector<Triangle>> triangulate_area(const Area& area) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : area.points) centre += p / static_cast<double>(area.points.size());
  const Eigen::Vector3d normal = normal_of(area.points).normalized();  // zero stays zero
  if (normal.isZero()) return refuse(Code::kBadShape, "the area is a point or a line; draw it around something");
  const Eigen::Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<Eigen::Vector2d> flat;
  for (const Eigen::Vector3d& p : area.points) {
    const Eigen::Vector3d d = p - centre;
    if (std::abs(normal.dot(d)) > kMaxOffPlane) {
      return refuse(Code::kBadShape, "the area is not flat to within 5 cm; draw it in parts");
    }
    flat.emplace_back(u.dot(d), v.dot(d));
  }
  return triangulate(flat);
}

PlacedBox placed(const Box& box) {
  Transform T_frame_corner = Transform::Identity();
  T_frame_corner.translation() = box.min;
  return {T_frame_corner, box.max - box.min};
}

PlacedBox placed(const OrientedBox& box) { return {box.T_frame_box * Eigen::Translation3d(-0.5 * box.size), box.size}; }

std::vector<ConvexPiece> pieces_of(const Line& line, const Transform& T_map_frame, const CellFrame& cells) {
  std::vector<ConvexPiece> pieces;
  for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
    const Eigen::Vector3d a = cells.point(T_map_frame * line.points[i]);
    const Eigen::Vector3d b = cells.point(T_map_frame * line.points[i + 1]);
    pieces.push_back({{a, b}, {b - a}});
  }
  return pieces;
}

Result<std::vector<ConvexPiece>> pieces_of(const Area& area, const Transform& T_map_frame, const CellFrame& cells) {
  return triangulate_area(area).map([&](const std::vector<Triangle>& triangles) {
    std::vector<ConvexPiece> pieces;
    const auto point = [&](std::uint32_t i) { return cells.point(T_map_frame * area.points[i]); };
    for (const Triangle& t : triangles) pieces.push_back(flat_piece({point(t[0]), point(t[1]), point(t[2])}));
    return pieces;
  });
}

namespace {

struct PiecesOfVolume {
  const Transform& T_map_frame;
  const CellFrame& cells;

  Result<std::vector<ConvexPiece>> operator()(const Prism& prism) const {
    return triangulate(prism.points).map([&](const std::vector<Triangle>& triangles) {
      std::vector<ConvexPiece> pieces;
      Eigen::Vector3d shift = Eigen::Vector3d::Zero();
      const Eigen::Vector3d up =
          thick_edge(cells.direction(T_map_frame.linear().col(2)), prism.high - prism.low, shift);
      const auto point = [&](std::uint32_t i) -> Eigen::Vector3d {
        return cells.point(T_map_frame * Eigen::Vector3d(prism.points[i].x(), prism.points[i].y(), prism.low)) + shift;
      };
      for (const Triangle& t : triangles) {
        pieces.push_back(flat_piece({point(t[0]), point(t[1]), point(t[2])}));
        pieces.back().edges.push_back(up);
        for (int i = 0; i < 3; ++i) pieces.back().corners.push_back(pieces.back().corners[i] + up);
      }
      return pieces;
    });
  }
  template <class SomeBox>
  Result<std::vector<ConvexPiece>> operator()(const SomeBox& box) const {
    return std::vector<ConvexPiece>{piece_of(placed(box), T_map_frame, cells)};
  }
};

}  // namespace

Result<std::vector<ConvexPiece>> pieces_of(const Volume& volume, const Transform& T_map_frame, const CellFrame& cells) {
  return std::visit(PiecesOfVolume{T_map_frame, cells}, volume);
}

}  // namespace concord
