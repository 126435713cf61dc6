#pragma once

#include <vector>

#include <rapidcheck.h>

#include "core/shape.hpp"

namespace concord {

/// Draws for property tests; half of them on round values, where boundaries coincide.
[[nodiscard]] double any_number(double low, double high);
[[nodiscard]] Eigen::Vector3d any_point(double reach);
/// Any rotation, or one that maps axes to axes.
[[nodiscard]] Transform any_transform(double reach);
/// Simple, seldom convex, either way round.
[[nodiscard]] std::vector<Eigen::Vector2d> any_polygon(double reach);

/// One of the 24 rotations that map axes to axes.
[[nodiscard]] Eigen::Matrix3d any_right_turn();

/// A comb with `teeth` teeth, each 1 wide and 1 apart, `height` high, on a back 1 high.
[[nodiscard]] std::vector<Eigen::Vector2d> comb(int teeth, double height);
/// A corridor wound in a square spiral of so many corners, 1 wide with walls 1 apart.
[[nodiscard]] std::vector<Eigen::Vector2d> spiral(int corners);

}  // namespace concord
