#include "planner/search/jump_search.hpp"

#include <algorithm>

namespace concord {
namespace {

constexpr int kTieBits = 16;

/// Steps along a diagonal that are looked at in one go.
constexpr int kStride = 16;

/// Ids from here on are the start's directions.
constexpr std::uint32_t kFirstPart = JumpGraph::kNone - 8;

/// Total cost beyond the least possible, then what is left of it in units of half a cell or so.
std::uint64_t key_of(std::int64_t total, std::int64_t least, std::int64_t left) {
  return static_cast<std::uint64_t>(total - least) << kTieBits |
         static_cast<std::uint64_t>(std::min<std::int64_t>(left >> 18, (1 << kTieBits) - 1));
}

std::int64_t between(Spot a, Spot b) { return octile(a.x - b.x, a.y - b.y); }

/// The cell where a path from `a` to `b` goes straight after its diagonal part.
Cell bend(Cell a, Cell b) {
  const int dx = b.x - a.x;
  const int dy = b.y - a.y;
  const int both = std::min(std::abs(dx), std::abs(dy));
  return {a.x + (dx >= 0 ? both : -both), a.y + (dy >= 0 ? both : -both)};
}

/// Appends the way to `to`, which is seen from the last of `turns`.
void append(std::vector<Cell>& turns, Cell to) {
  const Cell middle = bend(turns.back(), to);
  if (middle != turns.back() && middle != to) turns.push_back(middle);
  if (to != turns.back()) turns.push_back(to);
}

}  // namespace

void JumpSearch::begin() {
  if (++query_ == 0) {
    states_.clear();
    query_ = 1;
  }
  states_.resize(graph_.size());
  open_.clear();
  expanded_ = 0;
}

void JumpSearch::reach(const JumpGraph::Edge& edge, Spot from, std::int64_t cost, NodeId parent) {
  State& state = states_[edge.target];
  const std::int64_t total = cost + between(from, edge.at);
  if (state.query != query_ || total < state.cost) {
    state = {total, query_, parent, edge.onward, 0};
  } else if (total == state.cost && (edge.onward & ~(state.pending | state.done)) != 0) {
    // Another way of the same cost may go on where the first may not.
    const bool is_queued = state.pending != 0;
    state.pending |= edge.onward & ~state.done;
    if (is_queued) return;
  } else {
    return;
  }
  const std::int64_t left = between(edge.at, goal_);
  open_.push({key_of(total + left, least_, left), edge.target});
}

/// The start has no list of what it leads to: it is looked for in one direction after the other, and along diagonals
/// bit by bit, no sooner than a path that way could be the shortest.
void JumpSearch::push_part(int part) {
  const Spot last = scanned_[part];
  const Spot next{static_cast<std::uint16_t>(last.x + kDx[part]), static_cast<std::uint16_t>(last.y + kDy[part])};
  const std::int64_t left = between(next, goal_);
  open_.push({key_of(between(start_, next) + left, least_, left), kFirstPart + static_cast<std::uint32_t>(part)});
}

void JumpSearch::scan_part(int part) {
  first_.clear();
  JumpGraph::View view;
  if (part < 4) {
    graph_.scan_straight(start_, part, first_, view);
  } else if (graph_.scan_diagonal(scanned_[part], part, kStride, first_, view)) {
    push_part(part);
  }
  for (const JumpGraph::Edge& edge : first_) reach(edge, start_, 0, JumpGraph::kNone);
}

std::optional<OctilePath> JumpSearch::find(Cell start, Cell goal) {
  begin();
  if (!graph_.grid().is_open(start) || !graph_.grid().is_open(goal)) return std::nullopt;
  start_ = spot_of(start);
  goal_ = spot_of(goal);
  least_ = between(start_, goal_);
  if (graph_.is_direct(start_, goal_)) return trace(JumpGraph::kNone, least_);
  scanned_.fill(start_);
  for (int part = 0; part < 8; ++part) push_part(part);
  while (!open_.empty()) {
    const NodeId id = open_.top().id;
    open_.pop();
    if (id >= kFirstPart) {
      scan_part(static_cast<int>(id - kFirstPart));
      continue;
    }
    State& state = states_[id];
    const JumpGraph::Parts parts = state.pending;
    if (parts == 0) continue;  // it was reached at less cost since
    ++expanded_;
    const Spot at = graph_.at(id);
    // Straight to the goal costs no more than what any other way can.
    if (graph_.is_direct(at, graph_.view(id), goal_)) return trace(id, state.cost + between(at, goal_));
    state.done |= parts;
    state.pending = 0;
    const std::int64_t cost = state.cost;
    graph_.for_each_edge(id, parts, [&](const JumpGraph::Edge& edge) { reach(edge, at, cost, id); });
  }
  return std::nullopt;
}

OctilePath JumpSearch::trace(NodeId last, std::int64_t cost) {
  spots_.assign(1, goal_);
  for (NodeId id = last; id != JumpGraph::kNone; id = states_[id].parent) spots_.push_back(graph_.at(id));
  OctilePath path{cost, {}, expanded_};
  path.turns.reserve(2 * spots_.size() + 1);
  path.turns.push_back(cell_of(start_));
  for (auto spot = spots_.rbegin(); spot != spots_.rend(); ++spot) append(path.turns, cell_of(*spot));
  return path;
}

}  // namespace concord
