#include "planner/plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "planner/clearance.hpp"

namespace concord {
namespace {

PlanResult refusal(Reason reason, std::string message) {
  PlanResult result;
  result.reason = reason;
  result.message = std::move(message);
  return result;
}

}  // namespace

std::optional<Objection> check_request(const Eigen::Vector2d& start, const Eigen::Vector2d& goal, double radius,
                                       double resolution) {
  if (!start.allFinite() || !goal.allFinite() || !std::isfinite(radius)) {
    return Objection{Reason::kBadRequest, "start, goal and radius must be numbers, in metres"};
  }
  if (radius < 0 || radius > kMaxRadius || radius / resolution > kMaxRadiusCells) {
    return Objection{Reason::kBadRequest, "the robot's radius must be from 0 to " +
                                              metres(std::min(kMaxRadius, kMaxRadiusCells * resolution))};
  }
  return std::nullopt;
}

double least_clearance(const RobotTask& task, std::span<const Eigen::Vector2d> points) {
  // Ends, because beyond the map all is unknown, and zones end.
  for (double reach = task.radius + 4 * task.terrain().resolution();; reach *= 2) {
    if (const auto found = clearance(task.terrain(), points, reach)) return *found;
  }
}

PlanResult finish(const RobotTask& task, Route::Found found) {
  PlanResult result;
  result.expanded = found.way.expanded;
  result.reason = found.way.reason;
  result.message = std::move(found.way.message);
  result.legs = std::move(found.legs);
  result.cut = found.way.cut;
  if (result.reason != Reason::kOk) return result;
  std::vector<Eigen::Vector2d> points = std::move(found.way.points);
  if (!is_clear(task.terrain(), points, task.radius)) {
    return refusal(Reason::kValidationFailed, "the path that was found does not stand the final check: report this");
  }
  for (std::size_t i = 1; i < points.size(); ++i) result.length += (points[i] - points[i - 1]).norm();
  result.least_clearance = least_clearance(task, points);
  result.points = std::move(points);
  result.message = "a path of " + metres(result.length) + ", at least " + metres(result.least_clearance) +
                   " from anything occupied or unknown" +
                   (task.terrain().zones().has_no_go() ? " and from no-go zones" : "");
  return result;
}

PlanResult plan(const Terrain& terrain, const Eigen::Vector2d& start, const Eigen::Vector2d& goal, double radius) {
  if (auto wrong = check_request(start, goal, radius, terrain.resolution())) {
    return refusal(wrong->reason, std::move(wrong->message));
  }
  if (terrain.grid().cells().empty())
    return refusal(Reason::kNoMap, "nothing has been observed in the height band yet");
  RobotGrids grids(terrain, 0);
  const RobotTask task{grids, radius};
  return finish(task, *Route(start, {}, goal).find(task, std::numeric_limits<std::int64_t>::max()));
}

}  // namespace concord
