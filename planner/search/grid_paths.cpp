#include "planner/search/grid_paths.hpp"

#include <cmath>

#include "planner/lattice/sight.hpp"

namespace concord {
namespace {

/// From each turn straight to the last that it sees.
TautPath pulled(const OpenGrid& grid, const OctilePath& path) {
  const std::vector<Cell>& turns = path.turns;
  TautPath taut{0, {turns.front()}, path.expanded};
  for (std::size_t from = 0; from + 1 < turns.size();) {
    std::size_t to = turns.size() - 1;
    while (to > from + 1 && !sees(grid, turns[from], turns[to])) --to;
    taut.length += std::hypot(turns[to].x - turns[from].x, turns[to].y - turns[from].y);
    taut.turns.push_back(turns[to]);
    from = to;
  }
  return taut;
}

}  // namespace

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

GridPaths::GridPaths(OpenGrid grid, int reach, SightRule also)
    : grid_(std::move(grid)), reach_(reach), also_(std::move(also)) {}

bool GridPaths::sees(Cell a, Cell b) const { return concord::sees(grid_, a, b) && (!also_ || also_(a, b)); }

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
  clearance_ = std::make_unique<ClearanceSearch>(grid_, *field_, also_);
  clearance_->heed(extra_.get());
}

bool GridPaths::set_extra(Cell cell, int cost) {
  if (!extra_) {
    if (cost == 0) return false;
    extra_ = std::make_unique<ExtraCosts>(grid_);
    if (clearance_) clearance_->heed(extra_.get());
  }
  if (extra_->at(cell) == cost) return false;
  extra_->set(cell, cost);
  return true;
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

std::optional<ClearPath> GridPaths::clear_or_fast(Cell start, Cell goal, std::int64_t most_expanded) {
  if (auto path = clear(start, goal, {.expanded = most_expanded})) return path;
  const auto shortest = fast(start, goal);
  if (!shortest) return std::nullopt;
  ClearPath path = clearance_->shorten(cells_of(shortest->turns));
  path.is_fast = true;
  return path;
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
