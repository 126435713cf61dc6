#pragma once

#include <vector>

#include "core/transform.hpp"
#include "semantic/brick_masks.hpp"
#include "semantic/models/triangle_mesh.hpp"

namespace concord {

/// How a model lies on the occupied surface of a map.
struct ObjectFit {
  Transform T_map_model = Transform::Identity();
  double matched =
      0;  ///< share of the model's surface that lies within a voxel of what is occupied: half, seen from one side
  double rms = 0;    ///< metres, of that share: from the surface to the centres of what is occupied
  double shift = 0;  ///< metres from where it was said to be
  double turn = 0;   ///< radians
};

inline constexpr double kFarthestFit = 0.5;  ///< metres, of its middle
inline constexpr double kMostTurned = 0.6;   ///< radians

/// Points all over a model's surface, half a voxel apart, at most kMaxFitPoints, metres in the model's own axes.
/// Refused: as by voxelize.
[[nodiscard]] Result<std::vector<Eigen::Vector3d>> surface_points(const TriangleMesh& mesh, double scale,
                                                                  double resolution);
inline constexpr std::size_t kMaxFitPoints = 4000;

/// Lays a model onto what is occupied near it: ICP, point to point, from the surface to the nearest occupied voxel's
/// centre; what it reaches for shrinks from `reach` metres to a voxel and a half within kFitSteps steps. It comes to
/// lie right to a voxel and a half. Where it would leave the bounds above, or fit worse than before, it stays where it
/// was said to be. @pre points are not empty.
[[nodiscard]] ObjectFit fit_object(const std::vector<Eigen::Vector3d>& p_model, const BrickMasks& occupied,
                                   double resolution, const Transform& T_map_model, double reach = kFarthestFit);
inline constexpr int kFitSteps = 30;

}  // namespace concord
