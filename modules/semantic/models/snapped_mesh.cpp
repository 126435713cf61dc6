#include "semantic/models/snapped_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace concord {
namespace {

/// For each corner the first one that lies where it does.
std::vector<std::uint32_t> first_of_equals(const std::vector<Snapped>& vertices) {
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return vertices[a] != vertices[b] ? vertices[a] < vertices[b] : a < b;
  });
  std::vector<std::uint32_t> first(vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && vertices[order[i]] == vertices[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

}  // namespace

Result<SnappedMesh> snap(const TriangleMesh& mesh, const ModelPlacement& placement, double resolution) {
  if (!(placement.scale > 0.0) || !std::isfinite(placement.scale)) {
    return refuse(Code::kBadRequest, "a model's unit must be positive");
  }
  SnappedMesh out;
  out.vertices.reserve(mesh.vertices.size());
  for (const Eigen::Vector3d& p : mesh.vertices) {
    const Eigen::Vector3d q = placement.T_map_model * (placement.scale * p) / resolution;
    // A voxel's width from the edge, so that rounding leads nowhere beyond it.
    if (!(q.cwiseAbs().maxCoeff() <= kMaxVoxel - 2)) {
      return refuse(Code::kOutOfBounds, "the model would lie beyond the map's bounds; is its unit right?");
    }
    const auto snapped = [&](int axis) { return std::llround(q[axis] * static_cast<double>(kSnap)); };
    out.vertices.push_back({snapped(0), snapped(1), snapped(2)});
  }
  out.triangles = mesh.triangles;
  return out;
}

bool is_watertight(const SnappedMesh& mesh) {
  const std::vector<std::uint32_t> first = first_of_equals(mesh.vertices);
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const std::uint64_t a = first[triangle[i]], b = first[triangle[(i + 1) % 3]];
      if (a != b) edges.push_back(std::min(a, b) << 32 | std::max(a, b));
    }
  }
  std::ranges::sort(edges);
  for (auto it = edges.begin(); it != edges.end();) {
    const auto end = std::find_if(it, edges.end(), [&](std::uint64_t edge) { return edge != *it; });
    if ((end - it) % 2 != 0) return false;
    it = end;
  }
  return true;
}

}  // namespace concord
