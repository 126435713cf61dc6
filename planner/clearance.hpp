#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "planner/grid.hpp"

namespace concord {

/// The validator: the least distance of a polyline (map frame, metres) to any blocked cell, that is to the closed
/// square of a cell that is not free; 0 if it enters or touches one. Nothing where no cell is nearer than `reach`.
/// Shares no code with the search: plain geometry on the grid's own cells.
[[nodiscard]] std::optional<double> clearance(const Grid& grid, std::span<const Eigen::Vector2d> points, double reach);

/// Whether a robot of `radius` metres may follow the polyline: its disc overlaps no blocked cell anywhere on the way,
/// and the line itself touches none.
[[nodiscard]] bool is_clear(const Grid& grid, std::span<const Eigen::Vector2d> points, double radius);

}  // namespace concord
