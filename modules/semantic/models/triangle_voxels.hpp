#pragma once

#include <array>

#include "core/error.hpp"
#include "semantic/brick_masks.hpp"
#include "semantic/models/snapped_mesh.hpp"

namespace concord {

/// Of one model: columns of voxels that all its triangles may span, each counted for every triangle.
inline constexpr std::int64_t kMaxModelColumns = 200'000'000;
/// Voxels and bricks that one model may fill.
inline constexpr std::int64_t kMaxModelVoxels = 100'000'000;
inline constexpr std::size_t kMaxModelBricks = 2'000'000;

/// Adds the voxels that hold at least one point of a triangle. A voxel is half open, as everywhere: index i covers
/// [i, i + 1) on each axis. So a face that lies in the boundary of two voxels belongs to the upper one alone, and a
/// triangle without area is the line or the point that it is.
///
/// Exact: the thirteen axes of Akenine-Moeller's test (Fast 3D triangle-box overlap testing, 2001) in integers, each
/// solved for a range of voxels instead of asked for every voxel (as Schwarz and Seidel, Fast parallel surface and
/// solid voxelization, 2010, do). An open side of the voxel turns "touches" into "apart": shrinking the box by any
/// small amount on its upper sides changes nothing else, and touching only there is lost.
void add_surface(const std::array<Snapped, 3>& corners, BrickMasks& out);

/// All triangles of a mesh. Refused (kTooLarge): over kMaxModelColumns or kMaxModelBricks, before they are walked.
[[nodiscard]] Result<BrickMasks> surface_of(const SnappedMesh& mesh);

[[nodiscard]] std::array<Snapped, 3> corners_of(const SnappedMesh& mesh, std::size_t triangle);

}  // namespace concord
