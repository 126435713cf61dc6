#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "planner/route.hpp"

namespace concord {

/// Robots wider than this, metres or cells, are refused: no door is, and time grows with the square.
inline constexpr double kMaxRadius = 10.0;
inline constexpr double kMaxRadiusCells = 1024.0;

struct PlanResult {
  Reason reason = Reason::kNoMap;
  std::string message;                  ///< for a person
  std::vector<Eigen::Vector2d> points;  ///< map frame, metres, from the exact start to the exact goal; empty unless kOk
  std::vector<std::int32_t> legs;       ///< of each point; if one fails, that one alone
  double length = 0.0;                  ///< metres
  double least_clearance = 0.0;         ///< least distance to a cell that is not free, or no-go, metres
  std::int64_t expanded = 0;            ///< cells the search looked at
  std::optional<Eigen::Vector2d> cut;   ///< metres: where what cuts the way off begins
};

/// What no map is needed for to refuse. `resolution`: metres.
[[nodiscard]] std::optional<Objection> check_request(const Eigen::Vector2d& start, const Eigen::Vector2d& goal,
                                                     double radius, double resolution);

/// Least distance of a polyline (metres) to what a robot may not enter.
[[nodiscard]] double least_clearance(const RobotTask& task, std::span<const Eigen::Vector2d> points);

/// What was found, in metres, measured, and with the validator's last word on it. The ends stay exact.
[[nodiscard]] PlanResult finish(const RobotTask& task, Route::Found found);

/// A path for a round robot of `radius` metres over free cells, at any angle: one that keeps away from what is blocked,
/// straight where that is as good, and checked by code that did not plan it. Unknown cells are walls, so are no-go
/// zones. Any input is answered; the same input in the same way.
[[nodiscard]] PlanResult plan(const Terrain& terrain, const Eigen::Vector2d& start, const Eigen::Vector2d& goal,
                              double radius);

}  // namespace concord
