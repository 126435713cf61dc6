#pragma once

#include <Eigen/Geometry>

#include "core/error.hpp"

namespace concord {

/// A rigid transform, named T_target_source: p_target = T_target_source * p_source. Metres.
using Transform = Eigen::Isometry3d;

/// Whether a matrix turns and does nothing else, to a millionth; false for NaN and infinity.
[[nodiscard]] bool is_rotation(const Eigen::Matrix3d& R);

inline constexpr double kFarthestPlacement = 10'000.0;  ///< metres along each axis

/// From outside: position in metres and a quaternion (x, y, z, w) that is normalised if its norm is within 1e-3 of 1.
/// Refused: NaN or infinity, a quaternion that is no rotation, a translation over 10 km.
[[nodiscard]] Result<Transform> make_transform(const Eigen::Vector3d& position, const Eigen::Vector4d& xyzw);

}  // namespace concord
