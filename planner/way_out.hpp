#pragma once

#include <optional>
#include <string>

#include "planner/leg.hpp"

namespace concord {

/// The way out of the no-go zones that a robot stands in.
struct WayOut {
  std::string zone;                     ///< one that it stands in
  std::vector<Eigen::Vector2d> points;  ///< metres, from where it stands to the first place outside
};

/// Nothing where the robot does not stand in a no-go zone or too near to one, or cannot get out. The way is the
/// shortest one that touches nothing but no-go zones.
[[nodiscard]] std::optional<WayOut> way_out(const RobotTask& task, const Eigen::Vector2d& from);

}  // namespace concord
