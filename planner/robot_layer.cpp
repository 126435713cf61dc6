#include "planner/robot_layer.hpp"

#include <algorithm>
#include <cmath>

namespace concord {
namespace {

/// The cells whose square the disc overlaps, by columns, ascending.
std::vector<ColumnPlane> disc(const Eigen::Vector2d& p, double radius) {
  std::map<BrickIndex, std::uint64_t> planes;
  const auto first = [&](double at) { return static_cast<std::int32_t>(std::floor(at - radius)); };
  const auto last = [&](double at) { return static_cast<std::int32_t>(std::floor(at + radius)); };
  for (std::int32_t y = first(p.y()); y <= last(p.y()); ++y) {
    for (std::int32_t x = first(p.x()); x <= last(p.x()); ++x) {
      const Eigen::Vector2d low(x, y);
      if ((p - p.cwiseMax(low).cwiseMin(low + Eigen::Vector2d::Ones())).norm() >= radius) continue;
      planes[{x >> 3, y >> 3, 0}] |= std::uint64_t{1} << ((x & 7) | (y & 7) << 3);
    }
  }
  std::vector<ColumnPlane> cells;
  for (const auto& [column, plane] : planes) cells.push_back({column, plane});
  return cells;
}

}  // namespace

std::vector<BrickIndex> RobotLayer::columns_of(const std::vector<ColumnPlane>& cells) {
  std::vector<BrickIndex> columns;
  for (const ColumnPlane& plane : cells) columns.push_back(plane.column);
  return columns;
}

void RobotLayer::take_away(const std::string& robot, const Standing& standing) {
  for (const ColumnPlane& plane : standing.cells) {
    const auto it = columns_.find(plane.column);
    it->second.erase(robot);
    if (it->second.empty()) columns_.erase(it);
  }
}

std::vector<BrickIndex> RobotLayer::set(const std::string& robot, const Eigen::Vector2d& p, double radius) {
  const auto it = standing_.find(robot);
  if (it != standing_.end() && it->second.radius == radius && (it->second.p - p).norm() <= it->second.slack) return {};
  std::vector<BrickIndex> changed = remove(robot);
  Standing now{p, radius, std::max(1.0, radius / 4), {}};
  now.cells = disc(p, radius + now.slack);
  for (const ColumnPlane& plane : now.cells) columns_[plane.column][robot] = plane.cells;
  const std::vector<BrickIndex> taken = columns_of(now.cells);
  standing_.emplace(robot, std::move(now));
  changed.insert(changed.end(), taken.begin(), taken.end());
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  return changed;
}

std::vector<BrickIndex> RobotLayer::remove(const std::string& robot) {
  const auto it = standing_.find(robot);
  if (it == standing_.end()) return {};
  take_away(robot, it->second);
  std::vector<BrickIndex> columns = columns_of(it->second.cells);
  standing_.erase(it);
  return columns;
}

std::vector<BrickIndex> RobotLayer::leave_out(const std::string& robot) {
  if (robot == left_out_) return {};
  std::vector<BrickIndex> changed;
  for (const std::string& name : {left_out_, robot}) {
    const auto it = standing_.find(name);
    if (it == standing_.end()) continue;
    const std::vector<BrickIndex> columns = columns_of(it->second.cells);
    changed.insert(changed.end(), columns.begin(), columns.end());
  }
  left_out_ = robot;
  return changed;
}

std::uint64_t RobotLayer::at(BrickIndex column) const {
  const auto it = columns_.find(column);
  if (it == columns_.end()) return 0;
  std::uint64_t cells = 0;
  for (const auto& [robot, plane] : it->second) {
    if (robot != left_out_) cells |= plane;
  }
  return cells;
}

std::string RobotLayer::robot_near(const Eigen::Vector2d& p, double reach) const {
  for (const auto& [robot, standing] : standing_) {
    const double room = standing.radius + standing.slack + reach + std::sqrt(2.0);
    if (robot != left_out_ && (standing.p - p).norm() <= room) return robot;
  }
  return {};
}

std::vector<std::string> RobotLayer::robots() const {
  std::vector<std::string> names;
  for (const auto& [robot, standing] : standing_) names.push_back(robot);
  return names;
}

const RobotLayer& no_robots() {
  static const auto& none = *new RobotLayer;
  return none;
}

}  // namespace concord
