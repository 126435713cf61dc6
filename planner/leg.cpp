#include "planner/leg.hpp"

#include <algorithm>
#include <utility>

#include "planner/blame.hpp"
#include "planner/clearance.hpp"

namespace concord {
namespace {

using Points = std::vector<Eigen::Vector2d>;

/// A robot further than that from every cell of its way has left it; cells.
constexpr double kBeside = 4.0;

Finding failure(Objection objection) { return {objection.reason, std::move(objection.message), {}, 0, {}, false}; }

/// The nearest ones that hang together, of the cells that each end can go to.
std::optional<std::pair<Cell, Cell>> connected_pair(RobotGrid& grid, const std::vector<Cell>& starts,
                                                    const std::vector<Cell>& goals) {
  for (const Cell start : starts) {
    for (const Cell goal : goals) {
      if (grid.paths().connected(grid.local(start), grid.local(goal))) return std::pair(start, goal);
    }
  }
  return std::nullopt;
}

/// How near a line comes to what is blocked, as far as it matters to a search that keeps away from it.
double gap(const Terrain& terrain, double radius, Points points) {
  for (Eigen::Vector2d& p : points) p *= terrain.resolution();
  const double reach = radius + GridPaths::kReach * terrain.resolution();
  return clearance(terrain, points, reach).value_or(reach);
}

/// Leaves the second point out where the first, less than a cell from it, does as well.
void drop_anchor(const RobotTask& task, RobotGrid& grid, Points& points, bool at_end) {
  if (points.size() < 3) return;
  if (at_end) std::reverse(points.begin(), points.end());
  const bool is_own = cell_of(points[0]) == cell_of(points[1]);
  const bool is_there = points[0] == points[1];
  if (is_there || (is_own && grid.space().sees(points[0], points[2]) &&
                   gap(task.terrain(), task.radius, {points[0], points[2]}) >=
                       gap(task.terrain(), task.radius, {points[0], points[1], points[2]}))) {
    points.erase(points.begin() + 1);
  }
  if (at_end) std::reverse(points.begin(), points.end());
}

}  // namespace

Leg::Ends Leg::in_cells(const RobotTask& task) const {
  const double r = task.terrain().resolution();
  return {from_.position / r, to_.position / r};
}

std::optional<Finding> Leg::check(const RobotTask& task) {
  kept_.reset();
  anchors_.reset();
  for (const End* end : {&from_, &to_}) {
    if (auto objection = check_cell(task.terrain(), *end)) return failure(std::move(*objection));
  }
  const auto [from, to] = in_cells(task);
  const auto area = task.grids.areas().around(cell_of(from));
  const auto grid = area ? task.grids.at(task.in_cells(), Ignoring::kNothing, *area) : nullptr;
  if (grid == nullptr) {
    return failure({Reason::kSearchLimit, "the part of the map that hangs together around " + describe(from_) +
                                              " is over " + std::to_string(RobotGrids::kMaxCells / 1'000'000) +
                                              " million cells large"});
  }
  FreeSpace& space = grid->space();
  for (const End* end : {&from_, &to_}) {
    const Eigen::Vector2d p = end->position / task.terrain().resolution();
    if (!space.sees(p, p)) return failure(too_near(task.terrain(), *end, task.radius));
  }
  const std::vector<Cell> starts = concord::anchors(space, from);
  const std::vector<Cell> goals = concord::anchors(space, to);
  anchors_ = connected_pair(*grid, starts, goals);
  if (anchors_ || space.sees(from, to)) return std::nullopt;
  if (starts.empty()) return failure(too_narrow(from_, task.radius));
  if (goals.empty()) return failure(too_narrow(to_, task.radius));
  return what_closes(task, from, to);
}

Finding Leg::find(const RobotTask& task) {
  if (!anchors_) return {Reason::kOk, {}, {from_.position, to_.position}, 0, {}, false};
  const auto grid =
      task.grids.at(task.in_cells(), Ignoring::kNothing, *task.grids.areas().around(cell_of(in_cells(task).from)));
  kept_.emplace(grid->paths(), task.most_expanded);
  (void)kept_->plan(grid->local(anchors_->first), grid->local(anchors_->second));
  grid_ = grid;
  origin_ = grid->area().low;
  return found(task, *grid);
}

/// The turns, with the exact ends before and behind them.
Finding Leg::found(const RobotTask& task, RobotGrid& grid) const {
  const auto [from, to] = in_cells(task);
  Points points{from};
  for (const Cell turn : kept_->path()->turns) points.push_back(centre_of(grid.global(turn)));
  points.push_back(to);
  drop_anchor(task, grid, points, false);
  drop_anchor(task, grid, points, true);
  for (Eigen::Vector2d& p : points) p *= task.terrain().resolution();
  points.front() = from_.position;
  points.back() = to_.position;
  return {Reason::kOk, {}, std::move(points), kept_->path()->expanded, {}, false};
}

/// The grid as it is now, with the way in its cells.
std::shared_ptr<RobotGrid> Leg::bind(const RobotTask& task) {
  const auto area = task.grids.areas().around(cell_of(in_cells(task).from));
  auto grid = area ? task.grids.at(task.in_cells(), Ignoring::kNothing, *area) : nullptr;
  if (grid == nullptr || grid == grid_.lock()) return grid;
  const Cell corner = grid->area().low;
  const auto inside = [&](Cell cell) {
    return grid->paths().grid().holds({cell.x + origin_.x - corner.x, cell.y + origin_.y - corner.y});
  };
  if (!std::all_of(kept_->path()->cells.begin(), kept_->path()->cells.end(), inside)) return nullptr;
  grid->paths().prepare_clear();
  kept_->move_to(grid->paths(), {origin_.x - corner.x, origin_.y - corner.y});
  grid_ = grid;
  origin_ = corner;
  return grid;
}

/// Leaves out what lies behind the robot. False: it is not on its way.
bool Leg::begin_at(RobotGrid& grid, const Eigen::Vector2d& p) {
  const std::vector<Cell>& cells = kept_->path()->cells;
  const auto squared = [&](Cell cell) { return (centre_of(grid.global(cell)) - p).squaredNorm(); };
  const auto nearest =
      std::min_element(cells.begin(), cells.end(), [&](Cell a, Cell b) { return squared(a) < squared(b); });
  if (squared(*nearest) > kBeside * kBeside || !grid.space().sees(p, centre_of(grid.global(*nearest)))) return false;
  kept_->begin_at(static_cast<std::size_t>(nearest - cells.begin()));
  return true;
}

std::optional<Finding> Leg::follow(const RobotTask& task, const std::vector<Changed>& changes,
                                   const std::optional<Eigen::Vector2d>& at) {
  if (!kept_ || !kept_->path()) return std::nullopt;
  if (at) from_.position = *at;
  const auto grid = bind(task);
  if (grid == nullptr) return std::nullopt;
  const auto [from, to] = in_cells(task);
  if (!grid->space().sees(from, from) || !grid->space().sees(to, to)) return std::nullopt;
  if (at && !begin_at(*grid, from)) return std::nullopt;
  std::int64_t expanded = 0;
  bool is_kept = true;
  for (const Changed& change : changes) {
    const int reach = grid->reach();
    const Cell low = grid->local(change.cells.low);
    const Cell high = grid->local(change.cells.high);
    const Window window{{low.x - reach, low.y - reach}, {high.x + reach, high.y + reach}};
    const KeptPath::Outcome outcome = kept_->follow(window, change.opened);
    if (outcome == KeptPath::Outcome::kUnreachable) return std::nullopt;
    if (outcome == KeptPath::Outcome::kKept) continue;
    is_kept = false;
    expanded += kept_->path()->expanded;
  }
  const Cell first = grid->global(kept_->path()->cells.front());
  const Cell last = grid->global(kept_->path()->cells.back());
  if (!grid->space().sees(from, centre_of(first)) || !grid->space().sees(to, centre_of(last))) return std::nullopt;
  Finding finding = found(task, *grid);
  finding.expanded = expanded;
  finding.is_kept = is_kept;
  return finding;
}

Points Leg::improve(const RobotTask& task, std::int64_t& expanded) {
  if (!kept_ || !kept_->may_improve()) return {};
  const auto grid = bind(task);
  if (grid == nullptr) return {};
  const bool is_better = kept_->improve();
  expanded += grid->paths().clearance().expanded();
  return is_better ? found(task, *grid).points : Points{};
}

}  // namespace concord
