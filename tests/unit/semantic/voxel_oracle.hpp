#pragma once

#include <optional>
#include <set>

#include "semantic/models/snapped_mesh.hpp"

namespace concord {

/// Rational numbers and the plainest ways there are: shares nothing with what it checks but the snapped corners.

/// The voxels that hold a point of a triangle: each triangle is cut down to each voxel around it.
[[nodiscard]] std::set<VoxelIndex> surface_oracle(const SnappedMesh& mesh);

/// Whether a ray from the centre of a voxel crosses the triangles an odd number of times. The ray leans, and another is
/// taken where it meets an edge. @param voxel holds no point of a triangle.
[[nodiscard]] bool inside_oracle(const SnappedMesh& mesh, VoxelIndex voxel);

}  // namespace concord
