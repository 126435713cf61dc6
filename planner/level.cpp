#include "planner/level.hpp"

#include <algorithm>
#include <map>

namespace concord {
namespace {

/// So many tiles that a map is larger than when its cells were laid out before that is done anew.
constexpr int kSlack = 2;

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

std::vector<BrickIndex> columns_of(const std::vector<ColumnChange>& changes) {
  std::vector<BrickIndex> columns;
  columns.reserve(changes.size());
  for (const ColumnChange& change : changes) columns.push_back(change.column);
  return columns;
}

}  // namespace

Changed joined(const Changed& a, const Changed& b) {
  return {{{std::min(a.cells.low.x, b.cells.low.x), std::min(a.cells.low.y, b.cells.low.y)},
           {std::max(a.cells.high.x, b.cells.high.x), std::max(a.cells.high.y, b.cells.high.y)}},
          a.opened || b.opened};
}

Level::Level(Grid grid) : grid_(std::move(grid)), zones_(grid_.resolution(), grid_.band()), grids_(terrain(), kSlack) {}

Level::Update Level::project(const BrickMap& map, std::span<const BrickIndex> touched,
                             std::vector<BrickIndex>& columns) {
  const std::vector<ColumnChange> changes = grid_.update(map, touched);
  columns = columns_of(changes);
  grids_.follow(columns);
  return {places(changes), {}};
}

Level::Update Level::set_zones(std::span<const Zone> zones) {
  const ZoneLayer::Change change = zones_.set(zones);
  if (change.anywhere) grids_.clear();
  grids_.follow(columns_of(change.columns));
  return {change.anywhere ? std::vector{kAnything} : places(change.columns), {}};
}

Level::Update Level::moved(const std::string& robot, const std::vector<BrickIndex>& columns) {
  if (columns.empty()) return {};
  grids_.follow(columns);
  std::vector<ColumnChange> changes;
  for (const BrickIndex column : columns) changes.push_back({column, ~std::uint64_t{0}, ~std::uint64_t{0}});
  return {places(changes), robot};
}

Level::Update Level::set_robot(const std::string& robot, const Eigen::Vector2d& p, double radius) {
  return moved(robot, robots_.set(robot, p / grid_.resolution(), radius / grid_.resolution()));
}

Level::Update Level::remove_robot(const std::string& robot) { return moved(robot, robots_.remove(robot)); }

void Level::look_as(const std::string& robot) {
  const std::vector<BrickIndex> columns = robots_.leave_out(robot);
  if (!columns.empty()) grids_.follow(columns);
}

}  // namespace concord
