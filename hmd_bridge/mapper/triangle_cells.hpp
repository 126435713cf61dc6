#pragma once

#include <array>
#include <vector>

#include <Eigen/Geometry>

#include "core/lattice.hpp"

namespace concord::hmd {

/// Calls `visit(VoxelIndex)` for each cell that a triangle meets; corners in units of a cell's edge. A cell holds its
/// lower faces and not its upper ones, so a floor that lies on the face between two layers is in the upper one.
/// A triangle whose corners lie on one line, to a billionth, covers no area and meets none; its neighbours have its
/// edges. Looks at few cells that are not met, whatever the triangle's slope. @return false if there are more cells to
/// look at than `budget`, which is less by those that were. (Separating axes: Akenine-Moeller, "Fast 3D Triangle-Box
/// Overlap Testing", 2001.)
class TriangleCells {
 public:
  using Corners = std::array<Eigen::Vector3d, 3>;

  /// Appends the cells. @pre corners are finite and within 2^30.
  [[nodiscard]] static bool append(Corners corners, std::size_t& budget, std::vector<VoxelIndex>& out);
};

/// Whether a triangle meets the closed cell.
[[nodiscard]] bool meets(const TriangleCells::Corners& corners, VoxelIndex cell);

}  // namespace concord::hmd
