#include "planner/planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "planner/clearance.hpp"

namespace concord {
namespace {

/// Between two calls of `serve` about so many cells may be looked at: some 100 ms. Whatever a plan takes, it counts.
constexpr std::int64_t kEffort = 1'000'000;
constexpr std::int64_t kEffortOfAPlan = 2'000;
/// Cells of a rectangle that are made as soon as one is looked at.
constexpr std::int64_t kMadeAsSoon = 8;

/// Between two tries of a search that failed, and between two times that a path is said.
constexpr std::int64_t kSecond = 1'000'000;

/// Further than that many places of change are taken as one.
constexpr std::size_t kMostChanges = 16;

/// A clock that was set back makes nothing recent.
bool is_recent(std::int64_t utime, std::int64_t now) { return utime <= now && now - utime < kSecond; }

bool is_failed_search(const Path& path) {
  constexpr std::array kFailures{Reason::kNoValidPath, Reason::kWaypointUnreachable, Reason::kBlockedByEdit,
                                 Reason::kBlockedByUnknown, Reason::kSearchLimit};
  return std::any_of(kFailures.begin(), kFailures.end(), [&](Reason reason) { return path.status == name(reason); });
}

/// Of a path that there is, the words follow from its points.
bool same_answer(const Path& a, const Path& b) {
  return a.status == b.status && a.points == b.points && (!a.points.empty() || a.message == b.message);
}

Window around(const Window& a, const Window& b) {
  return {{std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y)},
          {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y)}};
}

Changed joined(const Changed& a, const Changed& b) { return {around(a.cells, b.cells), a.opened || b.opened}; }

/// Where the cells of the columns have changed, by tile.
std::vector<Changed> places(const std::vector<ColumnChange>& columns) {
  std::map<Cell, Changed> tiles;
  for (const ColumnChange& column : columns) {
    if ((column.blocked | column.freed) == 0) continue;
    const Cell low{column.column.x * 8, column.column.y * 8};
    const Changed here{{low, {low.x + 7, low.y + 7}}, column.freed != 0};
    const auto [it, is_new] = tiles.try_emplace(FreeSpace::tile_of(low), here);
    if (!is_new) it->second = joined(it->second, here);
  }
  std::vector<Changed> changes;
  for (const auto& [tile, change] : tiles) changes.push_back(change);
  return changes;
}

constexpr Changed kAnything{{{-kMaxVoxel, -kMaxVoxel}, {kMaxVoxel, kMaxVoxel}}, true};

/// The distance of `p` to the polyline.
double distance(const Eigen::Vector2d& p, const std::vector<Eigen::Vector2d>& points) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d& a = points[i];
    const Eigen::Vector2d d = points[std::min(i + 1, points.size() - 1)] - a;
    const double along = d.squaredNorm() > 0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
    least = std::min(least, (p - a - along * d).norm());
  }
  return least;
}

}  // namespace

Planner::Planner(Grid grid)
    : grid_(std::move(grid)), zones_(grid_.resolution(), grid_.band()), grids_(Terrain(grid_, zones_), 2) {}

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
  changed(change);
  std::vector<BrickIndex> columns;
  columns.reserve(change.columns.size());
  for (const ColumnChange& column : change.columns) columns.push_back(column.column);
  return columns;
}

void Planner::set_zones(std::span<const Zone> zones) {
  has_zones_ = true;
  changed(zones_.set(zones));
}

void Planner::changed(const ZoneLayer::Change& change) {
  ++version_;
  std::vector<BrickIndex> columns;
  for (const ColumnChange& column : change.columns) columns.push_back(column.column);
  if (change.anywhere) grids_.clear();
  grids_.follow(columns);
  const std::vector<Changed> changes = change.anywhere ? std::vector{kAnything} : places(change.columns);
  for (auto& [robot, active] : active_) follow(active, changes);
}

/// A failure may have another reason now, be it that nothing has changed that a robot could touch.
void Planner::follow(Active& active, const std::vector<Changed>& changes) {
  if (active.points.empty()) return wait(active);
  if (changes.empty()) return;
  active.changes.insert(active.changes.end(), changes.begin(), changes.end());
  if (active.changes.size() > kMostChanges) {
    Changed all = active.changes.front();
    for (const Changed& change : active.changes) all = joined(all, change);
    active.changes = {all};
  }
  wait(active);
}

bool Planner::set_pose(const std::string& robot, const Eigen::Vector2d& p_map) {
  if (poses_.size() >= kMaxPoses && !poses_.contains(robot)) return false;
  poses_[robot] = p_map;
  const auto it = active_.find(robot);
  if (it == active_.end()) return true;
  Active& active = it->second;
  if (active.route) active.route->pass(p_map, std::max(active.radius, grid_.resolution()));
  if (has_moved(active, p_map)) wait(active);
  if (is_far_off(active, p_map)) {
    active.must_begin_anew = true;
    wait(active);
  }
  return true;
}

void Planner::keep_poses(const std::set<std::string>& aligned) {
  std::erase_if(poses_, [&](const auto& pose) { return !aligned.contains(pose.first); });
}

/// Whether what a robot keeps away from on its path may be another than before.
bool Planner::comes_near(const Active& active, const std::vector<Changed>& changes) const {
  Eigen::Vector2d low = active.points.front();
  Eigen::Vector2d high = low;
  for (const Eigen::Vector2d& p : active.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double r = grid_.resolution();
  const double margin = std::max(active.radius, active.path.least_clearance) + r;
  return std::any_of(changes.begin(), changes.end(), [&](const Changed& change) {
    return change.cells.low.x * r <= high.x() + margin && (change.cells.high.x + 1) * r >= low.x() - margin &&
           change.cells.low.y * r <= high.y() + margin && (change.cells.high.y + 1) * r >= low.y() - margin;
  });
}

/// So far that a request which failed from where its robot was may succeed now. A robot that has a path follows it.
bool Planner::has_moved(const Active& active, const Eigen::Vector2d& p_map) const {
  if (active.request.start || !active.points.empty()) return false;
  return !active.start || (p_map - *active.start).norm() >= grid_.resolution();
}

/// A robot that is not on its path needs another.
bool Planner::is_far_off(const Active& active, const Eigen::Vector2d& p_map) const {
  if (active.request.start || active.points.empty()) return false;
  return distance(p_map, active.points) > std::max(1.0, 2 * active.radius) + 4 * grid_.resolution();
}

std::optional<Objection> Planner::objection(const Active& active) const {
  if (!active.start) {
    return Objection{Reason::kNoPose, "nobody has said where " + active.request.robot +
                                          " is in the map: align it, or give a start"};
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

/// What the request has now, if it was answered before or waits.
std::optional<Planner::Reply> Planner::known(const PathRequest& request) const {
  const auto is_it = [&](const Path& path) { return path.id == request.id && path.robot == request.robot; };
  const auto active = active_.find(request.robot);
  if (active != active_.end() && is_it(active->second.path)) return Reply{active->second.path, {}};
  const auto it = std::find_if(recent_.begin(), recent_.end(), is_it);
  if (it != recent_.end()) return Reply{*it, {}};
  const bool waits = std::any_of(waiting_.begin(), waiting_.end(), [&](const Active& other) {
    return other.request.id == request.id && other.request.robot == request.robot;
  });
  return waits ? std::optional(Reply{}) : std::nullopt;
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
  if (auto reply = known(request)) return *reply;
  Active now;
  now.request = request;
  now.radius = request.radius > 0 ? request.radius : radius;
  if (effort_ < kEffort && waiting_.empty() && find(now, moment)) return settle(std::move(now), moment);
  if (waiting_.size() < kMaxWaiting) {
    waiting_.push_back(std::move(now));
    return {};
  }
  take(now, {Reason::kBusy, "so many requests wait already: ask again later", {}, {}, 0, 0, 0, {}}, moment);
  return {now.path, {}};
}

/// What becomes of a request that has been answered.
Planner::Reply Planner::settle(Active active, const Moment& moment) {
  const PathRequest& request = active.request;
  const bool has_room = active_.size() < kMaxActive || active_.contains(request.robot);
  if (request.keep_active && !has_room) {
    active.path.message += "; it is not kept active, as so many robots' paths are already";
  }
  if (!request.keep_active || !has_room || active.path.status == name(Reason::kBadRequest)) {
    remember(active.path);
    return {active.path, {}};
  }
  active.path.active = true;
  active.said = moment.utime;
  Reply reply{active.path, end(request.robot)};
  const std::string robot = request.robot;
  active_.emplace(robot, std::move(active));
  return reply;
}

std::vector<Planner::Reply> Planner::serve(const Moment& moment) {
  effort_ = 0;
  std::vector<Reply> replies;
  while (!waiting_.empty() && effort_ < kEffort && find(waiting_.front(), moment)) {
    Active done = std::move(waiting_.front());
    waiting_.pop_front();
    replies.push_back(settle(std::move(done), moment));
  }
  return replies;
}

void Planner::wait(Active& active) {
  if (active.turn == 0) active.turn = ++turns_;
}

std::vector<Planner::Active*> Planner::due(const Moment& moment) {
  std::vector<Active*> due;
  for (auto& [robot, active] : active_) {
    const bool rests = active.points.empty() && !active.route && is_failed_search(active.path) &&
                       is_recent(active.path.utime, moment.utime);
    if (active.turn != 0 && !rests) due.push_back(&active);
  }
  std::sort(due.begin(), due.end(), [](const Active* a, const Active* b) { return a->turn < b->turn; });
  return due;
}

std::vector<Path> Planner::replan(const Moment& moment) {
  std::vector<Path> changed;
  for (Active* active : due(moment)) {
    if (effort_ >= kEffort) break;
    const Path before = active->path;
    if (!keep_up(*active, moment)) {
      if (!active->points.empty()) active->route.reset();
      active->points.clear();
      active->must_begin_anew = false;
      if (!find(*active, moment)) continue;
    }
    active->turn = 0;
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
