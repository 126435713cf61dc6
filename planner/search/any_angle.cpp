#include "planner/search/any_angle.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "planner/lattice/sight.hpp"

namespace concord {
namespace {

double between(Cell a, Cell b) {
  const double dx = a.x - b.x;
  const double dy = a.y - b.y;
  return std::sqrt(dx * dx + dy * dy);
}

using Quadrant = CornerSight::Quadrant;
constexpr std::array<Quadrant, 4> kQuadrants{{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};

/// Whether directions from (dx, dy) on, turning left or right, begin in the quadrant.
bool begins_in(Quadrant q, int dx, int dy, bool left) {
  // Along the axes it is the next one that they begin in.
  if (dx == 0) return q.y * dy > 0 && (left ? q.x != q.y : q.x == q.y);
  if (dy == 0) return q.x * dx > 0 && (left ? q.x == q.y : q.x != q.y);
  return q.x * dx > 0 && q.y * dy > 0;
}

}  // namespace

AnyAngleSearch::AnyAngleSearch(const OpenGrid& grid) : grid_(grid), sight_(grid) {
  states_.resize(static_cast<std::size_t>(grid.width()) * grid.height());
}

void AnyAngleSearch::reach(Cell cell, double length, std::uint32_t parent) {
  const std::uint32_t index = index_of(cell);
  State& state = states_[index];
  if (state.query == query_ && length >= state.length) return;
  state = {length, query_, parent, false};
  // Lengths are not negative: their bits are in the order of their values.
  open_.push({std::bit_cast<std::uint64_t>(length + between(cell, goal_)), index});
}

void AnyAngleSearch::look_around(Cell start) {
  seen_.clear();
  for (const Quadrant quadrant : kQuadrants) {
    sight_.look(start, quadrant, CornerSight::kSteepest, CornerSight::kFlattest, seen_);
  }
}

/// From a corner that was reached in a straight line: what lies between its going on and the blocked cell beside it.
void AnyAngleSearch::look_on(Cell at, Cell from) {
  seen_.clear();
  const int dx = at.x - from.x;
  const int dy = at.y - from.y;
  for (int corner = 0; corner < 4; ++corner) {
    const CornerSight::Quadrant blocked = kQuadrants[corner];
    if (!sight_.is_corner(at, blocked.x, blocked.y)) continue;
    const int side = dx * blocked.y - dy * blocked.x;
    if (side != 0) look_between(at, dx, dy, corner, side > 0);
  }
}

void AnyAngleSearch::look_between(Cell at, int dx, int dy, int corner, bool left) {
  using Sight = CornerSight;
  const Sight::Slope way{std::abs(dx), std::abs(dy)};
  int q = 0;
  while (!begins_in(kQuadrants[q], dx, dy, left)) ++q;
  for (bool is_first = true;; is_first = false, q = (q + (left ? 1 : 3)) & 3) {
    // Turning left, slopes fall in quadrants 0 and 2, and rise in the others.
    const bool falls = left == ((q & 1) == 0);
    const Sight::Slope begin = is_first ? way : falls ? Sight::kFlattest : Sight::kSteepest;
    const Sight::Slope end = q == corner ? Sight::Slope{1, 1} : falls ? Sight::kSteepest : Sight::kFlattest;
    sight_.look(at, kQuadrants[q], falls ? end : begin, falls ? begin : end, seen_);
    if (q == corner) return;
  }
}

std::optional<TautPath> AnyAngleSearch::find(Cell start, Cell goal) {
  expanded_ = 0;
  if (!grid_.is_open(start) || !grid_.is_open(goal)) return std::nullopt;
  if (++query_ == 0) {
    states_.assign(states_.size(), {});
    query_ = 1;
  }
  open_.clear();
  start_ = start;
  goal_ = goal;
  reach(start, 0, index_of(start));
  while (!open_.empty()) {
    const std::uint32_t index = open_.top().id;
    open_.pop();
    State& state = states_[index];
    if (state.is_done) continue;
    state.is_done = true;
    ++expanded_;
    const Cell at = cell_at(index);
    if (sees(grid_, at, goal)) return trace(at);
    if (at == start) {
      look_around(at);
    } else {
      look_on(at, cell_at(state.parent));
    }
    const double length = state.length;
    for (const Cell cell : seen_) reach(cell, length + between(at, cell), index);
  }
  return std::nullopt;
}

TautPath AnyAngleSearch::trace(Cell last) const {
  TautPath path{states_[index_of(last)].length + between(last, goal_), {goal_}, expanded_};
  if (goal_ == start_) return path;
  for (Cell at = last; at != start_; at = cell_at(states_[index_of(at)].parent)) {
    if (at != goal_) path.turns.push_back(at);
  }
  path.turns.push_back(start_);
  std::reverse(path.turns.begin(), path.turns.end());
  return path;
}

}  // namespace concord
