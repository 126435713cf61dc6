#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/brick_map.hpp"
#include "core/error.hpp"

namespace concord {

/// A point farther from the origin than this is refused, as a transform is (make_transform).
inline constexpr double kMaxSurfaceReach = 10'000.0;  // metres
inline constexpr std::size_t kMaxSurfacePoints = 4'000'000;
/// Of 4 x 4 x 4 voxels: a map of that takes 0.82 GB while it is made; walls of 3.9 million points 0.28 GB (measured).
inline constexpr std::size_t kMaxSurfaceBlocks = 500'000;
/// The finest map that can be aligned: cells of twice this reach kMaxSurfaceReach.
inline constexpr double kMinAlignResolution = 0.02;

/// What alignment sees of a map: the centres of the occupied voxels that border free or unknown space, in ascending
/// order of bricks and voxels; for a cloud, its points. Metres, in the frame of the map.
using SurfacePoints = std::vector<Eigen::Vector3f>;

/// Refused: over kMaxSurfacePoints of them (kTooLarge), a resolution below kMinAlignResolution or not finite
/// (kBadResolution), a voxel beyond kMaxSurfaceReach (kOutOfBounds).
[[nodiscard]] Result<SurfacePoints> surface_points(const BrickMap& map, double resolution);

/// A cloud's points. Refused: too many (kTooLarge), one that is not finite (kNotFinite: a sensor's marks of no return
/// are the reader's to leave out), one beyond kMaxSurfaceReach (kOutOfBounds).
[[nodiscard]] Result<SurfacePoints> surface_points(std::span<const Eigen::Vector3f> cloud);

/// Whether points touch over kMaxSurfaceBlocks blocks of 4 x 4 x 4 voxels; takes 8 bytes a point to find out.
/// @pre finite, within kMaxSurfaceReach; resolution >= kMinAlignResolution / 2.
[[nodiscard]] bool are_scattered(std::span<const Eigen::Vector3f> points, double resolution);

/// Leaves out points that stand alone in a dense surface: where the median point has 7 of the 27 voxels around it
/// taken, as a wall has, those with fewer than 5 are noise. A sparse surface stays as it is.
[[nodiscard]] SurfacePoints without_loners(SurfacePoints points, double resolution, int threads);

}  // namespace concord
