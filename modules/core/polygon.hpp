#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/error.hpp"

namespace concord {

/// Polygons and polylines with more points are refused: what a hand draws has fewer, and time grows with the square.
inline constexpr std::size_t kMaxShapePoints = 1024;

/// A coordinate beyond this, in metres, is refused: no lattice reaches so far.
inline constexpr double kFarthest = 16'777'216.0;

/// Positions of three corners in the list of points, counterclockwise.
using Triangle = std::array<std::uint32_t, 3>;

/// Cuts a polygon into triangles that cover it and do not overlap, by clipping ears (Meisters, "Polygons have ears",
/// 1975). Any simple polygon, convex or not, either way round, the last point joined to the first (which may be
/// repeated at the end). Metres. Decided exactly, in integers, on the points rounded to 2^-32 m: no rounding makes it
/// fail. Refused: fewer than 3 distinct points, no area, edges that cross or touch one another (kBadShape); NaN or
/// infinity (kNotFinite); a coordinate beyond kFarthest (kOutOfBounds); over kMaxShapePoints (kTooLarge).
[[nodiscard]] Result<std::vector<Triangle>> triangulate(std::span<const Eigen::Vector2d> points);

/// Whether a point lies in a simple polygon or within `margin` of its edges.
[[nodiscard]] bool encloses(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& p, double margin);

}  // namespace concord
