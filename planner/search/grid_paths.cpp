#include "planner/search/grid_paths.hpp"

#include <cmath>

#include "planner/lattice/sight.hpp"

namespace concord {
namespace {

/// Every cell of a path over eight directions.
std::vector<Cell> cells_of(const std::vector<Cell>& turns) {
  std::vector<Cell> cells{turns.front()};
  for (const Cell turn : turns) {
    while (cells.back() != turn) {
      const Cell at = cells.back();
      cells.push_back({at.x + (turn.x > at.x) - (turn.x < at.x), at.y + (turn.y > at.y) - (turn.y < at.y)});
    }
  }
  return cells;
}

/// From each cell straight to the last that it sees.
TautPath pulled(const OpenGrid& grid, const OctilePath& path) {
  const std::vector<Cell> cells = cells_of(path.turns);
  TautPath taut{0, {cells.front()}, path.expanded};
  for (std::size_t from = 0; from + 1 < cells.size();) {
    std::size_t to = cells.size() - 1;
    while (to > from + 1 && !sees(grid, cells[from], cells[to])) --to;
    taut.length += std::hypot(cells[to].x - cells[from].x, cells[to].y - cells[from].y);
    taut.turns.push_back(cells[to]);
    from = to;
  }
  return taut;
}

}  // namespace

GridPaths::GridPaths(OpenGrid grid, int reach) : grid_(std::move(grid)), reach_(reach) {}

void GridPaths::prepare_components() {
  if (!components_) components_ = std::make_unique<Components>(grid_);
}

void GridPaths::prepare_fast() {
  prepare_components();
  if (graph_) return;
  graph_ = std::make_unique<JumpGraph>(grid_);
  graph_->complete();
  jump_ = std::make_unique<JumpSearch>(*graph_);
}

void GridPaths::prepare_any_angle() {
  prepare_components();
  if (!any_angle_) any_angle_ = std::make_unique<AnyAngleSearch>(grid_);
}

void GridPaths::prepare_clear() {
  prepare_components();
  if (clearance_) return;
  field_ = std::make_unique<DistanceField>(grid_, reach_);
  clearance_ = std::make_unique<ClearanceSearch>(grid_, *field_);
}

bool GridPaths::connected(Cell a, Cell b) {
  if (!grid_.is_open(a) || !grid_.is_open(b)) return false;
  prepare_components();
  return components_->connected(a, b);
}

std::optional<OctilePath> GridPaths::fast(Cell start, Cell goal) {
  if (!connected(start, goal)) return std::nullopt;
  prepare_fast();
  return jump_->find(start, goal);
}

std::optional<TautPath> GridPaths::any_angle(Cell start, Cell goal) {
  if (!connected(start, goal)) return std::nullopt;
  prepare_any_angle();
  if (auto path = any_angle_->find(start, goal)) return path;
  return pulled(grid_, *fast(start, goal));
}

std::optional<ClearPath> GridPaths::clear(Cell start, Cell goal, const ClearanceSearch::Limits& limits) {
  if (!connected(start, goal)) return std::nullopt;
  prepare_clear();
  return clearance_->find(start, goal, limits);
}

std::vector<bool> GridPaths::cells(const Window& window) const {
  std::vector<bool> open;
  for (int y = window.low.y; y <= window.high.y; ++y) {
    for (int x = window.low.x; x <= window.high.x; ++x) open.push_back(grid_.is_open({x, y}));
  }
  return open;
}

bool GridPaths::follow(const Window& window, const std::vector<bool>& before) {
  const std::vector<bool> now = cells(window);
  if (now == before) return false;
  if (components_) components_->update(window);
  if (graph_) graph_->update(window);
  if (any_angle_) any_angle_->update(window);
  if (field_) field_->update(window);
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (now[i] && !before[i]) return true;
  }
  return false;
}

}  // namespace concord
