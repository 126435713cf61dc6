#pragma once

#include <cmath>

#include <Eigen/Core>

namespace concord {

/// Where a robot stands on the floor: its reference point, and where its x axis points, radians from the x axis of the
/// frame that the point is in.
struct Pose {
  Eigen::Vector2d p = Eigen::Vector2d::Zero();
  double yaw = 0;

  [[nodiscard]] Eigen::Vector2d heading() const { return {std::cos(yaw), std::sin(yaw)}; }
  [[nodiscard]] bool is_finite() const { return p.allFinite() && std::isfinite(yaw); }
};

/// The same angle within -pi to pi.
[[nodiscard]] inline double wrapped(double angle) { return std::remainder(angle, 2 * M_PI); }

}  // namespace concord
