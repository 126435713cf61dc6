#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "planner/route.hpp"
#include "planner/way_out.hpp"

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
  std::vector<std::string> zones;       ///< no-go zones near the path, by name
};

/// What no map is needed for to refuse. `resolution`: metres.
[[nodiscard]] std::optional<Objection> check_request(const Eigen::Vector2d& start, const Eigen::Vector2d& goal,
                                                     double radius, double resolution);

/// Least distance of a polyline (metres) to what a robot may not enter.
[[nodiscard]] double least_clearance(const RobotTask& task, std::span<const Eigen::Vector2d> points);

/// The distance of a point to the same, as far as a metre or what a search keeps away from.
[[nodiscard]] double clearance_at(const RobotTask& task, const Eigen::Vector2d& p);

/// What was found, measured, and with the validator's last word on it. A robot that stands in a no-go zone takes `exit`
/// first: on it the zones it stands in are not heeded.
[[nodiscard]] PlanResult finish(const RobotTask& task, Route::Found found, const std::optional<WayOut>& exit = {});

/// A path for a round robot of `radius` metres over free cells, at any angle: one that keeps away from what is blocked,
/// straight where that is as good, and checked by code that did not plan it. Unknown cells are walls, so are no-go
/// zones. Any input is answered; the same input in the same way.
[[nodiscard]] PlanResult plan(const Terrain& terrain, const Eigen::Vector2d& start, const Eigen::Vector2d& goal,
                              double radius);

}  // namespace concord
