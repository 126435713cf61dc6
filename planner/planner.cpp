#include "planner/planner.hpp"

#include <algorithm>
#include <cmath>

#include "planner/clearance.hpp"

namespace concord {
namespace {

/// One call of `replan` may look at about so many cells: some 100 ms. A plan without any search counts, too.
constexpr std::int64_t kEffort = 1'000'000;
constexpr std::int64_t kEffortOfAPlan = 10'000;

bool is_failed_search(const Path& path) {
  return path.status == name(Reason::kNoValidPath) || path.status == name(Reason::kSearchLimit);
}

bool waits_for_pose(const Path& path) {
  return path.status == name(Reason::kNoPose) || path.status.starts_with("START_");
}

Path to_path(const PathRequest& request, const PlanResult& result, double floor, const Planner::Moment& moment) {
  Path path;
  path.id = request.id;
  path.robot = request.robot;
  path.status = name(result.reason);
  path.message = result.message;
  for (const Eigen::Vector2d& p : result.points) path.points.emplace_back(p.x(), p.y(), floor);
  path.length = result.length;
  path.least_clearance = result.least_clearance;
  path.map_revision = moment.map_revision;
  path.utime = moment.utime;
  return path;
}

bool same_answer(const Path& a, const Path& b) { return a.status == b.status && a.points == b.points; }

}  // namespace

void Planner::set_brick(BrickIndex index, Brick brick) {
  if (map_.set(index, std::move(brick))) touched_.push_back(index);
}

void Planner::clear_map() {
  map_.for_each_brick([this](BrickIndex index, const Brick&) { touched_.push_back(index); });
  map_.clear();
}

std::vector<BrickIndex> Planner::project() {
  const std::vector<ColumnChange> changes = grid_.update(map_, touched_);
  touched_.clear();
  if (changes.empty()) return {};
  for (auto& [robot, active] : active_) {
    if (must_replan(active, changes)) wait(robot, active);
  }
  std::vector<BrickIndex> columns;
  columns.reserve(changes.size());
  for (const ColumnChange& change : changes) columns.push_back(change.column);
  return columns;
}

/// A path that stands is kept as long as it is clear. One that failed is tried again when it may succeed now, or when
/// its reason, which was found without a search, may have become another.
bool Planner::must_replan(const Active& active, const std::vector<ColumnChange>& changes) const {
  if (active.points.empty()) {
    return !is_failed_search(active.path) ||
           std::any_of(changes.begin(), changes.end(), [](const ColumnChange& change) { return change.freed != 0; });
  }
  Eigen::Vector2d low = active.points.front();
  Eigen::Vector2d high = low;
  for (const Eigen::Vector2d& p : active.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double margin = active.radius + grid_.resolution();
  const double side = kBrickSide * grid_.resolution();
  const bool near = std::any_of(changes.begin(), changes.end(), [&](const ColumnChange& change) {
    const Eigen::Vector2d corner(change.column.x * side, change.column.y * side);
    return change.blocked != 0 && (corner.array() <= high.array() + margin).all() &&
           (corner.array() + side >= low.array() - margin).all();
  });
  return near && !is_clear(grid_, active.points, active.radius);
}

bool Planner::set_pose(const std::string& robot, const Eigen::Vector2d& p_map) {
  const auto it = poses_.find(robot);
  if (it == poses_.end() && poses_.size() >= kMaxPoses) return false;
  const bool moved = it == poses_.end() || (it->second - p_map).norm() >= grid_.resolution();
  if (!moved) return true;
  poses_[robot] = p_map;
  const auto active = active_.find(robot);
  if (active != active_.end() && !active->second.request.start && waits_for_pose(active->second.path)) {
    wait(robot, active->second);
  }
  return true;
}

std::optional<Eigen::Vector2d> Planner::start_of(const PathRequest& request) const {
  if (request.start) return request.start;
  const auto it = poses_.find(request.robot);
  return it != poses_.end() ? std::optional(it->second) : std::nullopt;
}

PlanResult Planner::plan_for(const PathRequest& request, double radius) const {
  const std::optional<Eigen::Vector2d> start = start_of(request);
  if (start) return plan(grid_, *start, request.goal, radius);
  PlanResult result;
  result.reason = Reason::kNoPose;
  result.message = "nobody has said where " + request.robot + " is in the map: align it, or give a start";
  return result;
}

Path* Planner::known(const PathRequest& request) {
  const auto active = active_.find(request.robot);
  if (active != active_.end() && active->second.request.id == request.id) return &active->second.path;
  const auto it = std::find_if(recent_.begin(), recent_.end(),
                               [&](const Path& path) { return path.id == request.id && path.robot == request.robot; });
  return it != recent_.end() ? &*it : nullptr;
}

void Planner::remember(const Path& path) {
  recent_.push_back(path);
  recent_.back().active = false;  // it is looked up here when another request has ended it
  if (recent_.size() > kKeptPaths) recent_.pop_front();
}

Path Planner::request(const PathRequest& request, double radius, const Moment& moment) {
  if (const Path* path = known(request)) return *path;
  Active now{request, request.radius > 0 ? request.radius : radius, {}, {}, false};
  PlanResult result = plan_for(request, now.radius);
  now.path = to_path(request, result, grid_.band().floor, moment);
  active_.erase(request.robot);
  if (request.keep_active && active_.size() >= kMaxActive) {
    now.path.message += "; it is not kept active, as so many robots' paths are already";
  } else if (request.keep_active && result.reason != Reason::kBadRequest) {
    now.path.active = true;
    now.points = std::move(result.points);
  }
  remember(now.path);
  Path path = now.path;
  if (path.active) active_.emplace(request.robot, std::move(now));
  return path;
}

void Planner::wait(const std::string& robot, Active& active) {
  if (active.is_waiting) return;
  active.is_waiting = true;
  waiting_.push_back(robot);
}

std::vector<Path> Planner::replan(const Moment& moment) {
  std::vector<Path> changed;
  for (std::int64_t effort = 0; effort < kEffort && !waiting_.empty(); waiting_.pop_front()) {
    const auto it = active_.find(waiting_.front());
    if (it == active_.end() || !it->second.is_waiting) continue;  // another request came meanwhile
    Active& active = it->second;
    active.is_waiting = false;
    PlanResult result = plan_for(active.request, active.radius);
    effort += kEffortOfAPlan + result.expanded;
    Path path = to_path(active.request, result, grid_.band().floor, moment);
    path.active = true;
    const bool is_another = !same_answer(path, active.path);
    path.plan_number = active.path.plan_number + (is_another ? 1 : 0);
    active.path = path;
    active.points = std::move(result.points);
    if (is_another) changed.push_back(std::move(path));
  }
  return changed;
}

}  // namespace concord
