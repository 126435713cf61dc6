#pragma once

#include "planner/leg.hpp"

namespace concord {

/// What cut the way between two points (in cells) off: the no-go zones, edits or unobserved space without which there
/// would be one. Where it takes more than one of these, or a wall stands there, that is what is said.
/// @pre there is none.
[[nodiscard]] Finding what_closes(const RobotTask& task, const Eigen::Vector2d& from, const Eigen::Vector2d& to);

}  // namespace concord
