#include "planner/planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace concord {
namespace {

/// Further than that many places of change are taken as one.
constexpr std::size_t kMostChanges = 16;

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

}  // namespace concord
