#pragma once

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/lattice.hpp"

namespace concord {

/// Cells between two: how many steps a ray takes from one to the other.
[[nodiscard]] inline std::uint64_t steps_between(VoxelIndex a, VoxelIndex b) {
  const auto distance = [](std::int64_t i, std::int64_t j) { return static_cast<std::uint64_t>(std::abs(i - j)); };
  return distance(a.x, b.x) + distance(a.y, b.y) + distance(a.z, b.z);
}

/// Walks the cells that the segment from `start` to `end` crosses, the last one excluded, and calls `visit(VoxelIndex)`
/// for each; neighbours share a face. Points are in units of a voxel's edge. Through an edge or a corner x goes
/// before y before z. It ends after exactly as many steps as lie between the two cells, whatever is rounded
/// (Amanatides and Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", 1987).
template <class Visit>
void walk_ray(const Eigen::Vector3d& start, const Eigen::Vector3d& end, Visit&& visit) {
  const VoxelIndex last = voxel_of(end, 1.0);
  VoxelIndex cell = voxel_of(start, 1.0);
  const std::array<std::int32_t, 3> to{last.x - cell.x, last.y - cell.y, last.z - cell.z};
  const std::array<std::int32_t, 3> from{cell.x, cell.y, cell.z};
  std::array<std::int32_t, 3> sign;
  std::array<double, 3> next;   // share of the segment at which the next face of this axis is met
  std::array<double, 3> width;  // share of the segment between two faces of this axis
  std::array<std::int32_t, 3> left;
  for (int axis = 0; axis < 3; ++axis) {
    left[axis] = std::abs(to[axis]);
    sign[axis] = to[axis] < 0 ? -1 : 1;
    if (left[axis] == 0) {
      next[axis] = std::numeric_limits<double>::infinity();
      width[axis] = 0;
      continue;
    }
    const double length = std::abs(end[axis] - start[axis]);
    const double face = to[axis] < 0 ? start[axis] - from[axis] : from[axis] + 1 - start[axis];
    next[axis] = face / length;
    width[axis] = 1 / length;
  }
  const std::array<std::int32_t*, 3> coordinate{&cell.x, &cell.y, &cell.z};
  for (std::int32_t steps = left[0] + left[1] + left[2]; steps > 0; --steps) {
    visit(cell);
    int axis = next[1] < next[0] ? 1 : 0;
    if (next[2] < next[axis]) axis = 2;
    *coordinate[axis] += sign[axis];
    next[axis] = --left[axis] == 0 ? std::numeric_limits<double>::infinity() : next[axis] + width[axis];
  }
}

}  // namespace concord
