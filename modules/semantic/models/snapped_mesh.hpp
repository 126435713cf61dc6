#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/lattice.hpp"
#include "core/transform.hpp"
#include "semantic/models/triangle_mesh.hpp"

namespace concord {

/// A corner in 2^-24 of a voxel (3 nm at 5 cm): coordinates of 40 bits, so that every question about a triangle and a
/// voxel has an exact answer in integers of 128.
using Snapped = std::array<std::int64_t, 3>;
inline constexpr std::int64_t kSnap = std::int64_t{1} << 24;

struct SnappedMesh {
  std::vector<Snapped> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Where a model lies.
struct ModelPlacement {
  Transform T_map_model = Transform::Identity();
  double scale = 1.0;  ///< metres per unit of the file
};

/// Each corner p becomes T_map_model (scale p) / resolution, rounded once. Refused: a scale that is not positive and
/// finite (kBadRequest), anything beyond the map's bounds (kOutOfBounds). @pre check(mesh).
[[nodiscard]] Result<SnappedMesh> snap(const TriangleMesh& mesh, const ModelPlacement& placement, double resolution);

/// Whether the triangles enclose space: every edge between two snapped corners belongs to an even number of them. Then,
/// and only then, every ray from a point crosses the surface equally often, but for twos.
[[nodiscard]] bool is_watertight(const SnappedMesh& mesh);

}  // namespace concord
