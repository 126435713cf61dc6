// How the planner finds one path, and what becomes of it.
#include <cmath>
#include <utility>

#include "planner/clearance.hpp"
#include "planner/nearest.hpp"
#include "planner/planner.hpp"

namespace concord {
namespace {

/// Whatever a plan takes, it counts as so many cells looked at.
constexpr std::int64_t kEffortOfAPlan = 2'000;
/// Cells of a rectangle that are made as soon as one is looked at.
constexpr std::int64_t kMadeAsSoon = 8;

bool is_no_way(Reason reason) {
  return reason == Reason::kNoValidPath || reason == Reason::kBlockedByEdit || reason == Reason::kBlockedByUnknown;
}

PlanResult refusal(const Objection& objection) {
  PlanResult result;
  result.reason = objection.reason;
  result.message = objection.message;
  return result;
}

}  // namespace

std::optional<Objection> Planner::objection(const Active& active) const {
  if (!active.start) {
    return Objection{Reason::kNoPose,
                     "nobody has said where " + active.request.robot + " is in the map: align it, or give a start"};
  }
  const double r = grid().resolution();
  if (active.refused) return active.refused;
  if (auto wrong = check_request(*active.start, active.request.goal, active.robot.radius, r)) return wrong;
  if (active.level == nullptr) {
    return Objection{Reason::kBadRequest, "the heights of " + active.request.robot +
                                              " hold no voxel, or are one band too many: see the site file"};
  }
  if (active.level->grid().cells().empty()) {
    return Objection{Reason::kNoMap, "no map has arrived yet, or nothing has been observed in the height band"};
  }
  if (!has_zones_) {
    return Objection{Reason::kNoZones, "the no-go zones have not arrived from merge yet: ask again"};
  }
  if (is_stale_) {
    return Objection{Reason::kMapStale, "nothing was heard of the map for some seconds: is merge running?"};
  }
  return std::nullopt;
}

/// What is told of each point, as the terrain is now.
void Planner::measure(Active& active) {
  Path& path = active.path;
  const std::vector<std::int32_t> legs = [&] {
    std::vector<std::int32_t> old;
    for (const PathPoint& point : path.details) old.push_back(point.leg);
    return old;
  }();
  path.least_clearance = least_clearance(task(active), active.points);
  double along = 0;
  for (std::size_t i = 0; i < active.points.size(); ++i) {
    const std::size_t from = i + 1 < active.points.size() || i == 0 ? i : i - 1;
    const Eigen::Vector2d way = active.points[std::min(from + 1, active.points.size() - 1)] - active.points[from];
    if (i > 0) along += (active.points[i] - active.points[i - 1]).norm();
    path.details[i] = {std::atan2(way.y(), way.x()), clearance_at(task(active), active.points[i]), legs[i],
                       along / active.robot.speed};
  }
}

void Planner::take(Active& active, PlanResult result, const Moment& moment) {
  Path& path = active.path;
  path = Path{};
  path.id = active.request.id;
  path.robot = active.request.robot;
  path.status = name(result.reason);
  path.message = active.found = std::move(result.message);
  active.cut = result.reason == Reason::kBlockedByEdit ? result.cut : std::nullopt;
  path.length = result.length;
  path.radius = active.robot.radius;
  if (active.robot.body) {
    path.footprint = active.robot.body->footprint.polygon();
    path.turn_radius = active.robot.body->turn_radius;
  }
  if (active.level != nullptr) {
    const Band& band = active.level->grid().band();
    path.zmin = band.floor;
    path.zmax = band.ceiling;
  }
  for (const Eigen::Vector2d& p : result.points) path.points.emplace_back(p.x(), p.y(), path.zmin);
  path.map_revision = moment.map_revision;
  path.utime = moment.utime;
  path.path_id = last_path_ = std::max(last_path_ + 1, moment.utime);
  path.nearest = nearest(active, result);
  path.zones = std::move(result.zones);
  if (result.points.empty() && !result.legs.empty()) path.failed_leg = result.legs.front();
  active.points = std::move(result.points);
  active.poses.clear();
  if (active.points.empty()) return;
  path.details.resize(active.points.size());
  for (std::size_t i = 0; i < result.legs.size(); ++i) path.details[i].leg = result.legs[i];
  if (!active.robot.body) return measure(active);
  path.least_clearance = result.least_clearance;
}

/// Of a goal or waypoint that cannot be reached.
std::optional<Eigen::Vector2d> Planner::nearest(const Active& active, const PlanResult& result) const {
  const auto leg = result.legs.empty() ? std::size_t{0} : static_cast<std::size_t>(result.legs.front());
  const std::vector<Eigen::Vector2d>& waypoints = active.request.waypoints;
  const bool is_goals = result.reason == Reason::kGoalInNoGo || result.reason == Reason::kGoalOccupied ||
                        result.reason == Reason::kGoalUnknown || result.reason == Reason::kGoalClearance ||
                        result.reason == Reason::kGoalOutsideMap || result.reason == Reason::kWaypointUnreachable;
  if (!is_no_way(result.reason) && !is_goals) return std::nullopt;
  const Eigen::Vector2d from = active.exit ? active.exit->points.back() : *active.start;
  if (check_cell(active.level->terrain(), start_at(from))) return std::nullopt;
  return nearest_reachable(task(active), from, leg < waypoints.size() ? waypoints[leg] : active.request.goal);
}

/// What was done since the last call: cells that were looked at, and rectangles of cells that had to be made for that.
void Planner::charge(std::int64_t looked_at) {
  std::int64_t made = 0;
  for (const auto& level : levels_) made += level->grids().made() + level->poses().made();
  effort_ += looked_at + (made - std::exchange(made_, made)) / kMadeAsSoon;
}

/// From scratch, or on where it was left. False: not done yet.
bool Planner::find(Active& active, const Moment& moment) {
  const std::string& robot = active.request.robot;
  if (active.job && !active.job->is_over()) return false;
  if (active.level != nullptr) active.level->look_as(robot);
  if (active.robot.body) return find_poses(active, moment);
  if (!active.route) {
    const auto pose = poses_.find(robot);
    active.start = active.request.start;
    if (!active.start && pose != poses_.end()) active.start = pose->second.p;
    if (const auto wrong = objection(active)) {
      take(active, refusal(*wrong), moment);
      return true;
    }
    active.exit = way_out(task(active), *active.start);
    active.route.emplace(active.exit ? active.exit->points.back() : *active.start, active.request.waypoints,
                         active.request.goal);
    active.begun = version_;
  }
  auto found = active.route->find(task(active), kEffort - effort_);
  charge(kEffortOfAPlan + active.route->expanded());
  if (!found) return false;
  const bool is_way = found->way.reason == Reason::kOk;
  PlanResult result = finish(task(active), std::move(*found), active.exit);
  const bool has_changed = active.begun != version_;
  if (is_way && result.reason != Reason::kOk && has_changed) {
    active.route.reset();
    return false;
  }
  if (result.reason != Reason::kOk) active.route.reset();
  active.changes.clear();
  if (active.route && has_changed) active.changes.push_back(kAnything);
  take(active, std::move(result), moment);
  return true;
}

/// What stands of a path that there was, after the changes. False: it is to be found anew.
bool Planner::keep_up(Active& active, const Moment& moment) {
  if (active.points.empty() || !active.route || active.must_begin_anew || active.exit) return false;
  active.level->look_as(active.request.robot);
  const auto pose = poses_.find(active.request.robot);
  std::optional<Eigen::Vector2d> at;
  if (!active.request.start && pose != poses_.end()) at = pose->second.p;
  const std::vector<Changed> changes = std::exchange(active.changes, {});
  const bool is_near = comes_near(active, changes);
  const bool is_still_clear = !is_near || is_clear(active.level->terrain(), active.points, active.robot.radius);
  auto found = active.route->follow(task(active), changes, at);
  charge(kEffortOfAPlan + active.route->expanded());
  if (!found || (found->way.is_kept && is_still_clear)) {
    if (!is_still_clear) return false;
    if (is_near) measure(active);
    if (effort_ >= kEffort) return true;
    found = active.route->improve(task(active));
    charge(active.route->expanded());
    if (!found) return true;
  }
  PlanResult result = finish(task(active), std::move(*found));
  if (result.reason != Reason::kOk) return false;
  if (at) active.start = at;
  take(active, std::move(result), moment);
  return true;
}

}  // namespace concord
