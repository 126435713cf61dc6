#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "planner/terrain.hpp"

namespace concord {

/// The validator: plain geometry on the cells' closed squares (`Ground`); shares no code with the search.
enum class Against {
  kImpassable,   ///< cells that are not free, or in a no-go zone
  kUntouchable,  ///< of these, the ones that no allow-contact zone holds or a no-go zone does
};

/// The least distance of a polyline (map frame, metres) to such cells; 0 if it enters or touches one. Nothing where
/// none is nearer than `reach`.
[[nodiscard]] std::optional<double> clearance(const Terrain& terrain, std::span<const Eigen::Vector2d> points,
                                              double reach, Against against = Against::kImpassable);

/// Whether a robot of `radius` metres may follow the polyline: its disc overlaps no untouchable cell anywhere on the
/// way, and the line itself touches no impassable one.
[[nodiscard]] bool is_clear(const Terrain& terrain, std::span<const Eigen::Vector2d> points, double radius);

}  // namespace concord
