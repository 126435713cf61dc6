#pragma once

#include <string>
#include <vector>

#include "semantic/models/triangle_mesh.hpp"

namespace concord {

struct SampleMesh {
  std::string name;
  TriangleMesh mesh;
  bool watertight = true;
};

/// Twenty meshes: boxes, balls, rings, prisms, shells within shells, open ones, thin ones, slivers, soups.
[[nodiscard]] std::vector<SampleMesh> sample_meshes();

[[nodiscard]] TriangleMesh box_mesh(const Eigen::Vector3d& low, const Eigen::Vector3d& high);
[[nodiscard]] TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b);
/// A block, a motor on it to one side, a pipe out of the other; it stands on z = 0.
[[nodiscard]] TriangleMesh pump_mesh();

}  // namespace concord
