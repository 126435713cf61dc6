#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "core/lattice.hpp"

namespace concord::shape_oracle {

/// Plain geometry in long double, by clipping and nothing else: no separating axes, no triangles, no columns.
using Point = Eigen::Matrix<long double, 3, 1>;
using FlatPoint = Eigen::Matrix<long double, 2, 1>;

/// An axis-aligned box: a voxel made a little larger or smaller.
struct Cell {
  Point centre, half;
};
[[nodiscard]] Cell cell_of(VoxelIndex voxel, double resolution, long double grown);

/// Whether a point, segment or convex flat polygon meets a cell.
[[nodiscard]] bool meets(std::vector<Point> polygon, const Cell& cell);

/// A simple polygon, extruded.
struct Solid {
  Eigen::Transform<long double, 3, Eigen::Isometry> T_map_solid;
  std::vector<FlatPoint> points;
  long double low, high;
};
[[nodiscard]] bool meets(const Solid& solid, const Cell& cell);

[[nodiscard]] long double distance(const Point& p, const Point& a, const Point& b);
/// To a triangle.
[[nodiscard]] long double distance(const Point& p, const Point& a, const Point& b, const Point& c);

}  // namespace concord::shape_oracle
