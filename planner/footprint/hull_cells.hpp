#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "planner/lattice/open_grid.hpp"

namespace concord {

/// What overlaps by less than this touches: a millionth of a cell, far above the rounding of positions.
inline constexpr double kFootprintTouch = 1e-6;

/// Rows that a hull may cover.
inline constexpr int kMaxHullRows = 4096;

/// Whether the convex hull of `points`, moved by anything up to `slack` along x and along y, overlaps open cells only;
/// it may touch others. All of its area counts: for each row of cells, the cells from its leftmost point there to its
/// rightmost. Positions in cells. Takes time by its rows. False where it covers over kMaxHullRows.
[[nodiscard]] bool covers_open_cells(const OpenGrid& grid, std::span<const Eigen::Vector2d> points, double slack);

/// The corners of the convex hull, counter-clockwise.
[[nodiscard]] std::vector<Eigen::Vector2d> convex_hull(std::span<const Eigen::Vector2d> points);

}  // namespace concord
