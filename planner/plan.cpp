#include "planner/plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
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

std::vector<std::string> zones_near(const RobotTask& task, const std::vector<Eigen::Vector2d>& points) {
  const ZoneLayer& zones = task.terrain().zones();
  std::set<std::string> names;
  if (!zones.has_no_go()) return {};
  const double brick = kBrickSide * task.terrain().resolution();
  const double reach = task.radius + GridPaths::kReach * task.terrain().resolution();
  std::set<BrickIndex> columns;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d step = points[std::min(i + 1, points.size() - 1)] - points[i];
    const int samples = static_cast<int>(step.norm() / brick) + 1;
    for (int k = 0; k < samples; ++k) {
      const Eigen::Vector2d low = ((points[i] + step * k / samples).array() - reach) / brick;
      const Eigen::Vector2d high = ((points[i] + step * k / samples).array() + reach) / brick;
      for (auto y = static_cast<std::int32_t>(std::floor(low.y())); y <= std::floor(high.y()); ++y) {
        for (auto x = static_cast<std::int32_t>(std::floor(low.x())); x <= std::floor(high.x()); ++x) {
          const BrickIndex column{x, y, 0};
          if (zones.no_go(column) != 0) columns.insert(column);
        }
      }
    }
  }
  for (const BrickIndex column : columns) {
    for (std::string& name : zones.no_go_names(column)) names.insert(std::move(name));
  }
  return {names.begin(), names.end()};
}

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

double clearance_at(const RobotTask& task, const Eigen::Vector2d& p) {
  const double reach = std::max(1.0, task.radius + GridPaths::kReach * task.terrain().resolution());
  return clearance(task.terrain(), {&p, 1}, reach).value_or(reach);
}

PlanResult finish(const RobotTask& task, Route::Found found, const std::optional<WayOut>& exit) {
  PlanResult result;
  result.expanded = found.way.expanded;
  result.reason = found.way.reason;
  result.message = std::move(found.way.message);
  result.legs = std::move(found.legs);
  result.cut = found.way.cut;
  if (result.reason != Reason::kOk) return result;
  std::vector<Eigen::Vector2d> points = std::move(found.way.points);
  const bool is_out = !exit || is_clear(task.terrain().without(Ignoring::kNoGo), exit->points, task.radius);
  if (!is_out || !is_clear(task.terrain(), points, task.radius)) {
    return refusal(Reason::kValidationFailed, "the path that was found does not stand the final check: report this");
  }
  if (exit) {
    points.insert(points.begin(), exit->points.begin(), exit->points.end() - 1);
    result.legs.insert(result.legs.begin(), exit->points.size() - 1, result.legs.front());
  }
  for (std::size_t i = 1; i < points.size(); ++i) result.length += (points[i] - points[i - 1]).norm();
  result.least_clearance = least_clearance(task, points);
  result.zones = zones_near(task, points);
  result.points = std::move(points);
  result.message = "a path of " + metres(result.length) + ", at least " + metres(result.least_clearance) +
                   " from anything occupied or unknown" +
                   (task.terrain().zones().has_no_go() ? " and from no-go zones" : "");
  if (found.is_fast) {
    result.message +=
        "; as the search for one away from walls took too long, it is the shortest, and no costs are heeded";
  }
  if (exit) result.message = "it leaves the no-go zone '" + exit->zone + "' first: " + result.message;
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
  const std::optional<WayOut> exit = way_out(task, start);
  Route route(exit ? exit->points.back() : start, {}, goal);
  return finish(task, *route.find(task, std::numeric_limits<std::int64_t>::max()), exit);
}

}  // namespace concord
