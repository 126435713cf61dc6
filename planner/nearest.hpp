#pragma once

#include <optional>

#include "planner/leg.hpp"

namespace concord {

/// Of all places that a robot can go to from `from`, the cell centre nearest to `to`; metres. Nothing where it cannot
/// leave the place that it is at. @pre nobody objects to `from`.
[[nodiscard]] std::optional<Eigen::Vector2d> nearest_reachable(const RobotTask& task, const Eigen::Vector2d& from,
                                                               const Eigen::Vector2d& to);

}  // namespace concord
