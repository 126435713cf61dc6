#pragma once

#include "core/error.hpp"
#include "semantic/brick_masks.hpp"
#include "semantic/models/snapped_mesh.hpp"

namespace concord {

/// What a model fills.
struct ModelVoxels {
  BrickMasks surface;   ///< hold a point of a triangle, see add_surface
  BrickMasks interior;  ///< not of the surface, inside; see below
  bool watertight = false;
};

enum class Fill { kSurface, kSolid };

/// The exact voxels of a model in the map's lattice.
///
/// Interior, where the model is watertight (is_watertight): a voxel that holds no surface is inside when a ray from its
/// centre crosses the triangles an odd number of times, whichever way it goes. So an inner shell is a hollow, and so is
/// what two overlapping shells share.
/// Where it is not: a voxel that holds no surface is inside when no walk from outside reaches it through faces of
/// voxels that hold none. So cracks thinner than a voxel do no harm, and an open box stays a box.
///
/// Refused: `check` and `snap`; over kMaxModelVoxels and the caps of surface_of; for a model that is not watertight a
/// box around it of over kMaxFloodedVoxels (all kTooLarge).
[[nodiscard]] Result<ModelVoxels> voxelize(const TriangleMesh& mesh, const ModelPlacement& placement, double resolution,
                                           Fill fill);

inline constexpr std::int64_t kMaxFloodedVoxels = 1'000'000'000;

/// The two rules, without the surface's voxels taken off. Exact. Refused (kTooLarge).
[[nodiscard]] Result<BrickMasks> inside_by_parity(const SnappedMesh& mesh);
[[nodiscard]] Result<BrickMasks> not_reached_from_outside(const BrickMasks& surface);

}  // namespace concord
