#include "planner/search/kept_path.hpp"

#include <algorithm>

#include "planner/lattice/sight.hpp"

namespace concord {
namespace {

/// A repair may look at so many cells for each cell of the stretch, and at no more than a part of what the whole path
/// took: if it fails, little was lost.
constexpr std::int64_t kPerCell = 64;
constexpr std::int64_t kPart = 24;
/// What took no more cells than that is as soon found anew.
constexpr std::int64_t kSmall = 2048;

std::int64_t with_share(std::int64_t cost) {
  return static_cast<std::int64_t>(static_cast<double>(cost) * (1 + KeptPath::kShare));
}

Window grown(const Window& window, int by) {
  return {{window.low.x - by, window.low.y - by}, {window.high.x + by, window.high.y + by}};
}

bool holds(const Window& window, Cell cell) {
  return cell.x >= window.low.x && cell.x <= window.high.x && cell.y >= window.low.y && cell.y <= window.high.y;
}

/// Whether the rectangle around both cells does.
bool meets(const Window& window, Cell a, Cell b) {
  return std::max(a.x, b.x) >= window.low.x && std::min(a.x, b.x) <= window.high.x &&
         std::max(a.y, b.y) >= window.low.y && std::min(a.y, b.y) <= window.high.y;
}

Cell nearest(const Window& window, Cell cell) {
  return {std::clamp(cell.x, window.low.x, window.high.x), std::clamp(cell.y, window.low.y, window.high.y)};
}

}  // namespace

KeptPath::Outcome KeptPath::take(std::optional<ClearPath> found) {
  path_ = std::move(found);
  if (!path_) return Outcome::kUnreachable;
  may_improve_ = false;
  cost_ = path_->cost;
  expanded_ = path_->expanded;
  return Outcome::kAnew;
}

KeptPath::Outcome KeptPath::plan(Cell start, Cell goal) {
  start_ = start;
  goal_ = goal;
  return take(paths_->clear_or_fast(start, goal, most_expanded_));
}

void KeptPath::move_to(GridPaths& paths, Cell shift) {
  paths_ = &paths;
  const auto move = [&](Cell& cell) { cell = {cell.x + shift.x, cell.y + shift.y}; };
  move(start_);
  move(goal_);
  if (!path_) return;
  std::for_each(path_->cells.begin(), path_->cells.end(), move);
  std::for_each(path_->turns.begin(), path_->turns.end(), move);
}

void KeptPath::begin_at(std::size_t first) {
  if (first == 0) return;
  std::vector<Cell> cells(path_->cells.begin() + static_cast<std::ptrdiff_t>(first), path_->cells.end());
  start_ = cells.front();
  cost_ -= std::min(cost_, path_->sums[first]);
  const bool is_fast = path_->is_fast;
  path_ = paths_->clearance().shorten(std::move(cells));
  path_->is_fast = is_fast;
}

KeptPath::Outcome KeptPath::follow(const Window& window, bool opened) {
  if (!path_) return opened ? plan(start_, goal_) : Outcome::kUnreachable;
  if (!paths_->connected(start_, goal_)) return take(std::nullopt);
  const std::optional<Stretch> stretch = near(window);
  if (!stretch || is_open(window, *stretch)) {
    if (stretch) paths_->clearance().follow(*path_, stretch->first, stretch->last);
    if (path_->cost <= with_share(cost_)) {
      may_improve_ = may_improve_ || (opened && could_save(window));
      return Outcome::kKept;
    }
  }
  may_improve_ = may_improve_ || opened;
  if (stretch && expanded_ > kSmall && repair(*stretch, window)) return Outcome::kRepaired;
  return plan(start_, goal_);
}

bool KeptPath::improve() {
  if (!path_ || !may_improve_) return false;
  may_improve_ = false;
  const auto enough = static_cast<std::int64_t>(static_cast<double>(path_->cost) / (1 + kShare));
  auto other = paths_->clear(start_, goal_, {.cost = enough, .expanded = most_expanded_});
  if (!other) return false;
  (void)take(std::move(other));
  return true;
}

/// The cells whose cost the window may have changed.
std::optional<KeptPath::Stretch> KeptPath::near(const Window& window) const {
  const Window reach = grown(window, paths_->field().reach());
  const std::vector<Cell>& cells = path_->cells;
  const auto is_near = [&](Cell cell) { return holds(reach, cell); };
  const auto first = std::find_if(cells.begin(), cells.end(), is_near);
  // The straight lines stay close to the cells, but they may come nearer than these.
  if (first == cells.end()) {
    for (std::size_t i = 1; i < path_->turns.size(); ++i) {
      const Cell a = path_->turns[i - 1];
      const Cell b = path_->turns[i];
      if (meets(window, a, b) && !paths_->sees(a, b)) return Stretch{0, cells.size() - 1};
    }
    return std::nullopt;
  }
  const auto last = std::find_if(cells.rbegin(), cells.rend(), is_near);
  return Stretch{static_cast<std::size_t>(first - cells.begin()), static_cast<std::size_t>(cells.rend() - last) - 1};
}

/// Whether the lines and the cells that come to the window are still open.
bool KeptPath::is_open(const Window& window, const Stretch& stretch) const {
  const OpenGrid& grid = paths_->grid();
  // A step over a corner that was filled is not in any cell.
  const Window beside = grown(window, 1);
  for (std::size_t i = stretch.first; i <= stretch.last; ++i) {
    const Cell cell = path_->cells[i];
    if (holds(window, cell) && !grid.is_open(cell)) return false;
    if (i > 0 && holds(beside, cell) && !sees(grid, path_->cells[i - 1], cell)) return false;
  }
  for (std::size_t i = 1; i < path_->turns.size(); ++i) {
    if (meets(beside, path_->turns[i - 1], path_->turns[i]) && !paths_->sees(path_->turns[i - 1], path_->turns[i])) {
      return false;
    }
  }
  return true;
}

/// Whether a path by way of the window could cost so much less that it is worth to change. Only there did anything
/// become cheaper.
bool KeptPath::could_save(const Window& window) const {
  const Window reach = grown(window, paths_->field().reach());
  const std::int64_t least = ClearanceSearch::at_least(start_, nearest(reach, start_)) +
                             ClearanceSearch::at_least(nearest(reach, goal_), goal_);
  return with_share(least) < path_->cost;
}

bool KeptPath::repair(const Stretch& stretch, const Window& window) {
  const std::vector<Cell>& cells = path_->cells;
  // Room on both sides to turn off and back, as long as the stretch itself.
  const std::size_t room = stretch.last - stretch.first + 1;
  const std::size_t from = stretch.first > room ? stretch.first - room : 0;
  const std::size_t to = std::min(stretch.last + room, cells.size() - 1);
  const std::int64_t left = with_share(cost_) - path_->sums[from] - (path_->cost - path_->sums[to]);
  const auto count = static_cast<std::int64_t>(to - from + 1);
  const auto between = paths_->clear(cells[from], cells[to], {left + 1, std::min(kPerCell * count, expanded_ / kPart)});
  if (!between) return false;
  std::vector<Cell> whole(cells.begin(), cells.begin() + static_cast<std::ptrdiff_t>(from));
  whole.insert(whole.end(), between->cells.begin(), between->cells.end());
  whole.insert(whole.end(), cells.begin() + static_cast<std::ptrdiff_t>(to) + 1, cells.end());
  const bool is_fast = path_->is_fast;
  path_ = paths_->clearance().shorten_again(std::move(whole), *path_, from, to, grown(window, paths_->field().reach()));
  path_->is_fast = is_fast;
  return true;
}

}  // namespace concord
