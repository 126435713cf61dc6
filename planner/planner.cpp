#include "planner/planner.hpp"

#include <algorithm>
#include <cmath>

#include "planner/clearance.hpp"

namespace concord {
namespace {

/// One call of `replan` may look at about so many cells: some 100 ms. A plan without any search counts, too.
constexpr std::int64_t kEffort = 1'000'000;
constexpr std::int64_t kEffortOfAPlan = 10'000;

/// Between two tries of a search that failed, and between two times that a path is said.
constexpr std::int64_t kSecond = 1'000'000;

/// A clock that was set back makes nothing recent.
bool is_recent(std::int64_t utime, std::int64_t now) { return utime <= now && now - utime < kSecond; }

bool is_failed_search(const Path& path) {
  return path.status == name(Reason::kNoValidPath) || path.status == name(Reason::kSearchLimit);
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

/// Of a path that there is, the words follow from its points.
bool same_answer(const Path& a, const Path& b) {
  return a.status == b.status && a.points == b.points && (!a.points.empty() || a.message == b.message);
}

}  // namespace

void Planner::set_brick(BrickIndex index, Brick brick) {
  if (map_.set(index, std::move(brick))) touched_.push_back(index);
}

void Planner::clear_map() {
  map_.for_each_brick([this](BrickIndex index, const Brick&) { touched_.push_back(index); });
  map_.clear();
}

std::vector<BrickIndex> Planner::project() {
  const ZoneLayer::Change change{grid_.update(map_, touched_), false};
  touched_.clear();
  if (change.columns.empty()) return {};
  check_active(change);
  std::vector<BrickIndex> columns;
  columns.reserve(change.columns.size());
  for (const ColumnChange& column : change.columns) columns.push_back(column.column);
  return columns;
}

void Planner::set_zones(std::span<const Zone> zones) {
  has_zones_ = true;
  check_active(zones_.set(zones));
}

void Planner::check_active(const ZoneLayer::Change& change) {
  for (auto& [robot, active] : active_) {
    if (must_replan(active, change)) wait(active);
  }
}

/// A path that stands is kept as long as it is clear. One that failed is tried again when it may succeed now, or when
/// its reason, which was found without a search, may have become another.
bool Planner::must_replan(const Active& active, const ZoneLayer::Change& change) const {
  const std::vector<ColumnChange>& columns = change.columns;
  if (active.points.empty()) {
    return !is_failed_search(active.path) || change.anywhere ||
           std::any_of(columns.begin(), columns.end(), [&](const ColumnChange& column) {
             return (column.freed != 0 && active.reached.is_near(column.column)) ||
                    (column.blocked != 0 && active.but_for_zones.is_near(column.column));
           });
  }
  Eigen::Vector2d low = active.points.front();
  Eigen::Vector2d high = low;
  for (const Eigen::Vector2d& p : active.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double margin = active.radius + grid_.resolution();
  const double side = kBrickSide * grid_.resolution();
  const bool near = change.anywhere || std::any_of(columns.begin(), columns.end(), [&](const ColumnChange& column) {
                      const Eigen::Vector2d corner(column.column.x * side, column.column.y * side);
                      return column.blocked != 0 && (corner.array() <= high.array() + margin).all() &&
                             (corner.array() + side >= low.array() - margin).all();
                    });
  return near && !is_clear(grid_, active.points, active.radius, zones_);
}

bool Planner::set_pose(const std::string& robot, const Eigen::Vector2d& p_map) {
  if (poses_.size() >= kMaxPoses && !poses_.contains(robot)) return false;
  poses_[robot] = p_map;
  const auto active = active_.find(robot);
  if (active != active_.end() && has_moved(active->second, p_map)) wait(active->second);
  return true;
}

void Planner::keep_poses(const std::set<std::string>& aligned) {
  std::erase_if(poses_, [&](const auto& pose) { return !aligned.contains(pose.first); });
}

/// So far that a request which failed from where its robot was may succeed now. A robot that has a path follows it.
bool Planner::has_moved(const Active& active, const Eigen::Vector2d& p_map) const {
  if (active.request.start || !active.points.empty()) return false;
  if (!active.start) return true;
  const double enough =
      is_failed_search(active.path) ? std::max(active.radius, grid_.resolution()) : grid_.resolution();
  return (p_map - *active.start).norm() >= enough;
}

PlanResult Planner::answer(const Active& active) const {
  PlanResult none;
  if (!active.start) {
    none.reason = Reason::kNoPose;
    none.message = "nobody has said where " + active.request.robot + " is in the map: align it, or give a start";
    return none;
  }
  if (!has_zones_ && !grid_.cells().empty()) {
    none.reason = Reason::kNoZones;
    none.message = "the no-go zones have not arrived from merge yet: ask again";
    return none;
  }
  return plan(grid_, *active.start, active.request.goal, active.radius, zones_);
}

/// Returns the effort.
std::int64_t Planner::try_to_plan(Active& active, const Moment& moment) const {
  const PathRequest& request = active.request;
  const auto pose = poses_.find(request.robot);
  active.start = request.start;
  if (!active.start && pose != poses_.end()) active.start = pose->second;
  PlanResult result = answer(active);
  active.path = to_path(request, result, grid_.band().floor, moment);
  active.points = std::move(result.points);
  active.reached = std::move(result.reached);
  active.but_for_zones = std::move(result.but_for_zones);
  active.turn = 0;
  return kEffortOfAPlan + result.expanded;
}

const Path* Planner::known(const PathRequest& request) const {
  const auto active = active_.find(request.robot);
  if (active != active_.end() && active->second.request.id == request.id) return &active->second.path;
  const auto it = std::find_if(recent_.begin(), recent_.end(),
                               [&](const Path& path) { return path.id == request.id && path.robot == request.robot; });
  return it != recent_.end() ? &*it : nullptr;
}

void Planner::remember(const Path& path) {
  recent_.push_back(path);
  if (recent_.size() > kKeptPaths) recent_.pop_front();
}

std::optional<Path> Planner::end(const std::string& robot) {
  const auto it = active_.find(robot);
  if (it == active_.end()) return std::nullopt;
  Path last = std::move(it->second.path);
  active_.erase(it);
  last.active = false;
  last.message = "ended: another request of the robot's has taken its place";
  remember(last);
  return last;
}

Planner::Reply Planner::request(const PathRequest& request, double radius, const Moment& moment) {
  if (const Path* path = known(request)) return {*path, {}};
  Active now;
  now.request = request;
  now.radius = request.radius > 0 ? request.radius : radius;
  try_to_plan(now, moment);
  const bool has_room = active_.size() < kMaxActive || active_.contains(request.robot);
  if (request.keep_active && !has_room) {
    now.path.message += "; it is not kept active, as so many robots' paths are already";
  }
  if (!request.keep_active || !has_room || now.path.status == name(Reason::kBadRequest)) {
    remember(now.path);
    return {now.path, {}};
  }
  now.path.active = true;
  now.said = moment.utime;
  Reply reply{now.path, end(request.robot)};
  active_.emplace(request.robot, std::move(now));
  return reply;
}

void Planner::wait(Active& active) {
  if (active.turn == 0) active.turn = ++turns_;
}

std::vector<Planner::Active*> Planner::due(const Moment& moment) {
  std::vector<Active*> due;
  for (auto& [robot, active] : active_) {
    const bool rests = is_failed_search(active.path) && is_recent(active.path.utime, moment.utime);
    if (active.turn != 0 && !rests) due.push_back(&active);
  }
  std::sort(due.begin(), due.end(), [](const Active* a, const Active* b) { return a->turn < b->turn; });
  return due;
}

std::vector<Path> Planner::replan(const Moment& moment) {
  std::vector<Path> changed;
  std::int64_t effort = 0;
  for (Active* active : due(moment)) {
    if (effort >= kEffort) break;
    const Path before = std::move(active->path);
    effort += try_to_plan(*active, moment);
    const bool is_another = !same_answer(active->path, before);
    active->path.active = true;
    active->path.plan_number = before.plan_number + (is_another ? 1 : 0);
    if (!is_another) continue;
    active->said = moment.utime;
    changed.push_back(active->path);
  }
  return changed;
}

std::vector<Path> Planner::repeat(const Moment& moment) {
  std::vector<Path> paths;
  for (auto& [robot, active] : active_) {
    if (is_recent(active.said, moment.utime)) continue;
    if (active.turn == 0) active.path.map_revision = moment.map_revision;
    active.said = moment.utime;
    paths.push_back(active.path);
  }
  return paths;
}

}  // namespace concord
