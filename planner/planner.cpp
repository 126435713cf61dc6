#include "planner/planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace concord {
namespace {

/// More places of change than that are taken as one.
constexpr std::size_t kMostChanges = 16;

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

Planner::Planner(Grid grid) { levels_.push_back(std::make_unique<Level>(std::move(grid))); }

void Planner::set_brick(BrickIndex index, Brick brick) {
  if (map_.set(index, std::move(brick))) touched_.push_back(index);
}

void Planner::clear_map() {
  map_.for_each_brick([this](BrickIndex index, const Brick&) { touched_.push_back(index); });
  map_.clear();
}

std::vector<BrickIndex> Planner::project() {
  if (touched_.empty()) return {};
  std::vector<BrickIndex> first;
  for (const auto& level : levels_) {
    std::vector<BrickIndex> columns;
    const Level::Update update = level->project(map_, touched_, columns);
    if (!columns.empty()) heed(level.get(), update);
    if (level == levels_.front()) first = std::move(columns);
  }
  touched_.clear();
  return first;
}

void Planner::set_zones(std::span<const Zone> zones) {
  has_zones_ = true;
  said_zones_.assign(zones.begin(), zones.end());
  for (const auto& level : levels_) heed(level.get(), level->set_zones(zones));
}

/// Null: there are too many, or no voxel's centre lies in its band.
Level* Planner::level_for(const Robot& robot) {
  const Grid& first = grid();
  if (!robot.band) return levels_.front().get();
  const Result<Band> band = make_band(robot.band->first, robot.band->second, first.resolution());
  if (!band) return nullptr;
  for (const auto& level : levels_) {
    if (level->grid().band().first == band->first && level->grid().band().last == band->last) return level.get();
  }
  if (levels_.size() >= kMaxLevels) return nullptr;
  Grid own(first.resolution(), *band, first.free_share());
  own.update(map_, map_.sorted_bricks());
  levels_.push_back(std::make_unique<Level>(std::move(own)));
  Level* level = levels_.back().get();
  (void)level->set_zones(said_zones_);
  for (const auto& [name, pose] : poses_) {
    if (pose.radius > 0) (void)level->set_robot(name, pose.p, pose.radius);
  }
  return level;
}

void Planner::heed(const Level* level, const Level::Update& update) {
  ++version_;
  for (auto& [robot, active] : active_) {
    if (active.level == level && robot != update.except) follow(active, update.places);
  }
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

bool Planner::set_pose(const std::string& robot, const Eigen::Vector2d& p_map, double radius) {
  if (poses_.size() >= kMaxPoses && !poses_.contains(robot)) return false;
  poses_[robot] = {p_map, radius};
  for (const auto& level : levels_) {
    const Level::Update update = radius > 0 ? level->set_robot(robot, p_map, radius) : level->remove_robot(robot);
    if (!update.places.empty()) heed(level.get(), update);
  }
  const auto it = active_.find(robot);
  if (it == active_.end()) return true;
  Active& active = it->second;
  const double r = grid().resolution();
  if (active.route) active.route->pass(p_map, std::max(active.robot.radius, r));
  if (has_moved(active, p_map)) wait(active);
  if (is_far_off(active, p_map)) {
    active.must_begin_anew = true;
    wait(active);
  }
  return true;
}

void Planner::keep_poses(const std::set<std::string>& aligned) {
  for (auto it = poses_.begin(); it != poses_.end();) {
    if (aligned.contains(it->first)) {
      ++it;
      continue;
    }
    for (const auto& level : levels_) {
      const Level::Update update = level->remove_robot(it->first);
      if (!update.places.empty()) heed(level.get(), update);
    }
    it = poses_.erase(it);
  }
}

/// Whether what a robot keeps away from on its path may be another than before.
bool Planner::comes_near(const Active& active, const std::vector<Changed>& changes) const {
  Eigen::Vector2d low = active.points.front();
  Eigen::Vector2d high = low;
  for (const Eigen::Vector2d& p : active.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double r = grid().resolution();
  const double margin = std::max(active.robot.radius, active.path.least_clearance) + r;
  return std::any_of(changes.begin(), changes.end(), [&](const Changed& change) {
    return change.cells.low.x * r <= high.x() + margin && (change.cells.high.x + 1) * r >= low.x() - margin &&
           change.cells.low.y * r <= high.y() + margin && (change.cells.high.y + 1) * r >= low.y() - margin;
  });
}

/// So far that a request which failed from where its robot was may succeed now. A robot that has a path follows it.
bool Planner::has_moved(const Active& active, const Eigen::Vector2d& p_map) const {
  if (active.request.start || !active.points.empty()) return false;
  return !active.start || (p_map - *active.start).norm() >= grid().resolution();
}

/// A robot that is not on its path needs another.
bool Planner::is_far_off(const Active& active, const Eigen::Vector2d& p_map) const {
  if (active.request.start || active.points.empty()) return false;
  return distance(p_map, active.points) > std::max(1.0, 2 * active.robot.radius) + 4 * grid().resolution();
}

}  // namespace concord
