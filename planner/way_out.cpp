#include "planner/way_out.hpp"

#include <algorithm>
#include <queue>
#include <unordered_map>

#include "planner/clearance.hpp"

namespace concord {
namespace {

/// A way out is looked for among so many cells: 60 m x 60 m at 5 cm.
constexpr std::size_t kMostCells = 1'500'000;

/// The cells from `start` to the nearest one that is open in `outside`, by steps over sides through what is open
/// `inside`; empty: there is none.
std::vector<Cell> steps_out(FreeSpace& inside, FreeSpace& outside, Cell start) {
  std::unordered_map<Cell, Cell, CellHash> came_from{{start, start}};
  std::queue<Cell> left;
  left.push(start);
  while (!left.empty() && came_from.size() < kMostCells) {
    const Cell cell = left.front();
    left.pop();
    if (outside.is_open(cell)) {
      std::vector<Cell> cells{cell};
      while (cells.back() != start) cells.push_back(came_from.at(cells.back()));
      std::reverse(cells.begin(), cells.end());
      return cells;
    }
    for (const Cell next :
         {Cell{cell.x + 1, cell.y}, {cell.x - 1, cell.y}, {cell.x, cell.y + 1}, {cell.x, cell.y - 1}}) {
      if (inside.is_open(next) && came_from.emplace(next, cell).second) left.push(next);
    }
  }
  return {};
}

}  // namespace

std::optional<WayOut> way_out(const RobotTask& task, const Eigen::Vector2d& from) {
  const Terrain& terrain = task.terrain();
  const double r = terrain.resolution();
  const Eigen::Vector2d p = from / r;
  if (!terrain.zones().has_no_go() || !from.allFinite() || p.cwiseAbs().maxCoeff() >= kMaxVoxel) return std::nullopt;
  FreeSpace outside(terrain, task.in_cells());
  if (outside.sees(p, p)) return std::nullopt;
  FreeSpace inside(terrain.without(Ignoring::kNoGo), task.in_cells());
  const auto zone = terrain.zones().nearest_no_go(p, task.in_cells() + kTouch);
  if (!zone || !inside.sees(p, p)) return std::nullopt;
  for (const Cell start : anchors(inside, p)) {
    const std::vector<Cell> cells = steps_out(inside, outside, start);
    if (cells.empty()) continue;
    std::vector<Eigen::Vector2d> points{p};
    for (std::size_t i = 0; i < cells.size();) {
      // The furthest in a straight line; each sees the next.
      std::size_t next = i;
      for (std::size_t k = i; k < cells.size() && inside.sees(points.back(), centre_of(cells[k])); ++k) next = k;
      points.push_back(centre_of(cells[next]));
      i = next + 1;
    }
    for (Eigen::Vector2d& point : points) point *= r;
    points.front() = from;
    return WayOut{zone->name, std::move(points)};
  }
  return std::nullopt;
}

}  // namespace concord
