#include "planner/ends.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <tuple>

#include "planner/clearance.hpp"

namespace concord {
namespace {

std::string no_go(const std::string& zone) { return "the no-go zone '" + zone + "'"; }

/// Whether the cell lies in the smallest rectangle of 8 x 8 columns that holds all known cells.
bool is_inside(const Grid& grid, Cell cell) {
  BrickIndex low{kMaxVoxel, kMaxVoxel, 0};
  BrickIndex high{-kMaxVoxel, -kMaxVoxel, 0};
  grid.cells().for_each_brick([&](BrickIndex b, const Brick&) {
    low = {std::min(low.x, b.x), std::min(low.y, b.y), 0};
    high = {std::max(high.x, b.x), std::max(high.y, b.y), 0};
  });
  const BrickIndex b{cell.x >> 3, cell.y >> 3, 0};
  return b.x >= low.x && b.x <= high.x && b.y >= low.y && b.y <= high.y;
}

double least_clearance(const Terrain& terrain, const Eigen::Vector2d& p, double radius, Against against) {
  // Ends, because beyond the map all is unknown, and zones end.
  for (double reach = radius + 4 * terrain.resolution();; reach *= 2) {
    if (const auto found = clearance(terrain, {&p, 1}, reach, against)) return *found;
  }
}

}  // namespace

End start_at(const Eigen::Vector2d& position) {
  return {"start",
          position,
          Reason::kStartOutsideMap,
          Reason::kStartInNoGo,
          Reason::kStartOccupied,
          Reason::kStartUnknown,
          Reason::kStartClearance};
}

End goal_at(const Eigen::Vector2d& position) {
  return {"goal",
          position,
          Reason::kGoalOutsideMap,
          Reason::kGoalInNoGo,
          Reason::kGoalOccupied,
          Reason::kGoalUnknown,
          Reason::kGoalClearance};
}

std::string metres(double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.2f m", value);
  return text.data();
}

std::string describe(const End& end) {
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), " (%.2f, %.2f)", end.position.x(), end.position.y());
  return "the " + end.what + text.data();
}

std::optional<Objection> check_cell(const Terrain& terrain, const End& end) {
  const Eigen::Vector2d p_cells = end.position / terrain.resolution();
  if (p_cells.cwiseAbs().maxCoeff() >= kMaxVoxel)
    return Objection{end.outside, describe(end) + " lies outside the map"};
  const Cell cell = cell_of(p_cells);
  const LogOdds state = terrain.grid().at(cell);
  if (const std::string* zone = terrain.zones().no_go_at(cell)) {
    const char* too = is_free(state) ? "" : is_known(state) ? ", and is occupied" : ", and has not been observed free";
    return Objection{end.no_go, describe(end) + " lies in " + no_go(*zone) + too};
  }
  if (is_free(state)) {
    const std::uint64_t bit = std::uint64_t{1} << ((cell.x & 7) | (cell.y & 7) << 3);
    if ((terrain.robots().at({cell.x >> 3, cell.y >> 3, 0}) & bit) == 0) return std::nullopt;
    return Objection{end.clearance, describe(end) + " is where " + terrain.robots().robot_near(p_cells, 0) + " stands"};
  }
  if (is_known(state)) return Objection{end.occupied, describe(end) + " is occupied"};
  if (is_inside(terrain.grid(), cell)) return Objection{end.unknown, describe(end) + " has not been observed free"};
  return Objection{end.outside, describe(end) + " lies outside the map"};
}

Objection too_near(const Terrain& terrain, const End& end, double radius) {
  double gap = least_clearance(terrain, end.position, radius, Against::kUntouchable);
  // Where contact is allowed its body is clear, but its centre touches what it may not enter.
  if (gap >= radius) gap = least_clearance(terrain, end.position, radius, Against::kImpassable);
  const double r = terrain.resolution();
  const Eigen::Vector2d p = end.position / r;
  const auto zone = terrain.zones().nearest_no_go(p, gap / r + kTouch);
  const std::string robot = terrain.robots().robot_near(p, radius / r);
  FreeSpace without_robots(terrain.without(Ignoring::kRobots), radius / r);
  if (!robot.empty() && without_robots.sees(p, p)) {
    return {end.clearance, describe(end) + " is too near to where " + robot + " stands"};
  }
  FreeSpace without(terrain.without(Ignoring::kNoGo), radius / r);
  const bool is_zone_alone = zone && without.sees(p, p);
  return {end.clearance, describe(end) + " is " + metres(gap) + " from " +
                             (zone ? no_go(zone->name) : "the nearest wall or unobserved cell") + ", the robot needs " +
                             metres(radius) +
                             (zone && !is_zone_alone ? "; a wall or unobserved cell is too near as well" : "")};
}

Objection too_narrow(const End& end, double radius) {
  return {end.clearance, describe(end) + " is too narrow a place for a robot of radius " + metres(radius)};
}

std::vector<Cell> anchors(FreeSpace& space, const Eigen::Vector2d& p) {
  const Cell own = cell_of(p);
  const auto serves = [&](int dx, int dy) {
    const Cell cell{own.x + dx, own.y + dy};
    return space.is_open(cell) && space.sees(p, centre_of(cell));
  };
  std::vector<Cell> found;
  const bool own_serves = serves(0, 0);
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const Cell cell{own.x + dx, own.y + dy};
      const bool is_own = dx == 0 && dy == 0;
      const bool is_one_step =
          !is_own && own_serves && space.is_open({cell.x, own.y}) && space.is_open({own.x, cell.y});
      if (!is_one_step && serves(dx, dy)) found.push_back(cell);
    }
  }
  std::sort(found.begin(), found.end(), [&](Cell a, Cell b) {
    const double to_a = (centre_of(a) - p).squaredNorm();
    const double to_b = (centre_of(b) - p).squaredNorm();
    return std::tie(to_a, a.y, a.x) < std::tie(to_b, b.y, b.x);
  });
  return found;
}

}  // namespace concord
