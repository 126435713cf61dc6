// How the planner finds one path, and what becomes of it.
#include <utility>

#include "planner/clearance.hpp"
#include "planner/planner.hpp"

namespace concord {
namespace {

/// Whatever a plan takes, it counts as so many cells looked at.
constexpr std::int64_t kEffortOfAPlan = 2'000;
/// Cells of a rectangle that are made as soon as one is looked at.
constexpr std::int64_t kMadeAsSoon = 8;

}  // namespace

std::optional<Objection> Planner::objection(const Active& active) const {
  if (!active.start) {
    return Objection{Reason::kNoPose,
                     "nobody has said where " + active.request.robot + " is in the map: align it, or give a start"};
  }
  if (auto wrong = check_request(*active.start, active.request.goal, active.radius, grid_.resolution())) return wrong;
  if (grid_.cells().empty()) return Objection{Reason::kNoMap, "nothing has been observed in the height band yet"};
  if (!has_zones_) {
    return Objection{Reason::kNoZones, "the no-go zones have not arrived from merge yet: ask again"};
  }
  return std::nullopt;
}

void Planner::take(Active& active, PlanResult result, const Moment& moment) const {
  Path& path = active.path;
  path = Path{};
  path.id = active.request.id;
  path.robot = active.request.robot;
  path.status = name(result.reason);
  path.message = std::move(result.message);
  for (const Eigen::Vector2d& p : result.points) path.points.emplace_back(p.x(), p.y(), grid_.band().floor);
  path.length = result.length;
  path.least_clearance = result.least_clearance;
  path.map_revision = moment.map_revision;
  path.utime = moment.utime;
  active.points = std::move(result.points);
}

/// From scratch, or on where it was left. False: not done yet.
bool Planner::find(Active& active, const Moment& moment) {
  if (!active.route) {
    const auto pose = poses_.find(active.request.robot);
    active.start = active.request.start;
    if (!active.start && pose != poses_.end()) active.start = pose->second;
    if (const auto wrong = objection(active)) {
      take(active, {wrong->reason, wrong->message, {}, {}, 0, 0, 0, {}}, moment);
      return true;
    }
    active.route.emplace(*active.start, std::span<const Eigen::Vector2d>{}, active.request.goal);
    active.begun = version_;
  }
  const std::int64_t made = grids_.made();
  auto found = active.route->find(task(active), kEffort - effort_);
  effort_ += kEffortOfAPlan + active.route->expanded() + (grids_.made() - made) / kMadeAsSoon;
  if (!found) return false;
  const bool is_way = found->way.reason == Reason::kOk;
  PlanResult result = finish(task(active), std::move(*found));
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
  if (active.points.empty() || !active.route || active.must_begin_anew) return false;
  const auto pose = poses_.find(active.request.robot);
  std::optional<Eigen::Vector2d> at;
  if (!active.request.start && pose != poses_.end()) at = pose->second;
  const std::vector<Changed> changes = std::exchange(active.changes, {});
  const bool is_near = comes_near(active, changes);
  const bool is_still_clear = !is_near || is_clear(terrain(), active.points, active.radius);
  auto found = active.route->follow(task(active), changes, at);
  effort_ += kEffortOfAPlan + active.route->expanded();
  if (found && !(found->way.is_kept && is_still_clear)) {
    PlanResult result = finish(task(active), std::move(*found));
    if (result.reason != Reason::kOk) return false;
    if (at) active.start = at;
    take(active, std::move(result), moment);
    return true;
  }
  if (!is_still_clear) return false;
  if (is_near) active.path.least_clearance = least_clearance(task(active), active.points);
  if (effort_ >= kEffort) return true;
  auto better = active.route->improve(task(active));
  effort_ += active.route->expanded();
  if (!better) return true;
  PlanResult result = finish(task(active), std::move(*better));
  if (result.reason != Reason::kOk) return false;
  if (at) active.start = at;
  take(active, std::move(result), moment);
  return true;
}

}  // namespace concord
