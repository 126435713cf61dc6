#pragma once

#include <vector>

#include <Eigen/Core>

namespace concord {

/// Cuts a simple polygon, counter-clockwise, into triangles by its ears. Empty where rounding leaves none to cut.
[[nodiscard]] std::vector<std::vector<Eigen::Vector2d>> triangles(std::vector<Eigen::Vector2d> polygon);

}  // namespace concord
