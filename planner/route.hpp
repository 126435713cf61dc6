#pragma once

#include <vector>

#include <Eigen/Core>

#include "planner/free_space.hpp"
#include "planner/search.hpp"

namespace concord {

/// Between exact points and cell centres. All positions here are in cells.

[[nodiscard]] Cell cell_of(const Eigen::Vector2d& p);
[[nodiscard]] Eigen::Vector2d centre_of(Cell cell);

/// The cells around `p` that the robot can go to in a straight line. Those one step away from p's own are left out
/// where that one serves: the search gets there by itself.
[[nodiscard]] std::vector<Anchor> anchors(FreeSpace& space, const Eigen::Vector2d& p);

/// Leaves out every point that the path can do without, first from one end, then each that is left.
/// @pre each point sees the next.
[[nodiscard]] std::vector<Eigen::Vector2d> shorten(FreeSpace& space, const std::vector<Eigen::Vector2d>& points);

}  // namespace concord
