#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "align/free_space.hpp"
#include "align/surface_level.hpp"
#include "core/brick_map.hpp"
#include "core/error.hpp"

namespace concord {

/// What alignment keeps of one map; made once and used for any number of requests.
struct AlignMap {
  double resolution = 0.0;
  SurfacePoints points;
  std::vector<SurfaceLevel> levels;  ///< finest first: twice the resolution, 0.25 m, 0.5 m
  ObservedFreeSpace free;
  /// Turns the map's frame upright, as its own floors and walls have it.
  Eigen::Matrix3d R_upright_map = Eigen::Matrix3d::Identity();

  [[nodiscard]] bool empty() const { return points.empty(); }
  [[nodiscard]] const SurfaceLevel& fine() const { return levels.front(); }
};

/// Finest first, as AlignMap has them. @pre a resolution that make_align_map takes.
[[nodiscard]] std::vector<SurfaceLevel> make_levels(const SurfacePoints& points, double resolution, int threads);

/// Refused: see surface_points and are_scattered (kTooLarge).
[[nodiscard]] Result<AlignMap> make_align_map(const BrickMap& map, double resolution, int threads);
/// A cloud; `resolution` is about the distance between its points. Refused: as above; a resolution below
/// kMinAlignResolution (kBadResolution).
[[nodiscard]] Result<AlignMap> make_align_map(std::span<const Eigen::Vector3f> cloud, double resolution, int threads);

/// The map as a mirror in the plane x = 0 shows it.
[[nodiscard]] AlignMap mirrored(const AlignMap& map, int threads);

/// The direction that is up by the surface itself, to correct a gravity that is off by a few degrees: floors and
/// ceilings are level, walls are plumb, by total least squares under a shrinking gate. The identity where there is too
/// little to tell by, or where it would turn by more than 4.5 degrees.
[[nodiscard]] Eigen::Matrix3d upright(const SurfaceLevel& surface);

}  // namespace concord
