#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "planner/grid.hpp"
#include "planner/region.hpp"
#include "planner/zone_layer.hpp"

namespace concord {

/// Why there is no path; the names in README.md travel in `Path::status`.
enum class Reason {
  kOk,
  kBadRequest,
  kNoMap,
  kNoPose,
  kNoZones,
  kStartOutsideMap,
  kGoalOutsideMap,
  kStartInNoGo,
  kGoalInNoGo,
  kStartOccupied,
  kGoalOccupied,
  kStartUnknown,
  kGoalUnknown,
  kStartClearance,
  kGoalClearance,
  kNoValidPath,
  kSearchLimit,
  kValidationFailed,
};

/// E.g. "START_OCCUPIED".
[[nodiscard]] const char* name(Reason reason);

/// Robots wider than this, metres or cells, are refused: no door is, and time grows with the square.
inline constexpr double kMaxRadius = 10.0;
inline constexpr double kMaxRadiusCells = 1024.0;

/// Cells a search looks at before it gives up: 10,000 square metres at 5 cm, about a second.
inline constexpr std::int64_t kMaxExpanded = 4'000'000;

struct PlanResult {
  Reason reason = Reason::kNoMap;
  std::string message;                  ///< for a person
  std::vector<Eigen::Vector2d> points;  ///< map frame, metres, from the exact start to the exact goal; empty unless kOk
  double length = 0.0;                  ///< metres
  double least_clearance = 0.0;         ///< least distance to a cell that is not free, or no-go, metres
  std::int64_t expanded = 0;            ///< cells the search looked at
  Region reached;                       ///< of a search that failed: it fails again until something there becomes free
  Region but_for_zones;  ///< where there is a way if not for no-go zones: true until something there closes
};

/// A path for a round robot of `radius` metres over free cells, at any angle: the cheapest one over the grid's eight
/// directions, shortened wherever the robot's disc can go straight, and checked by code that did not plan it.
/// Unknown cells are walls, so are no-go zones. Any input is answered; the same input in the same way.
[[nodiscard]] PlanResult plan(const Grid& grid, const Eigen::Vector2d& start, const Eigen::Vector2d& goal,
                              double radius, const ZoneLayer& zones = no_zones());

}  // namespace concord
