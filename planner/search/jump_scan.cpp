// What a jump graph looks at cell by cell, or 64 cells at a time.
#include <algorithm>
#include <cstdlib>

#include "planner/search/jump_graph.hpp"

namespace concord {
namespace {

int quadrant_of(int dx, int dy) { return dy >= 0 ? (dx >= 0 ? 0 : 1) : (dx < 0 ? 2 : 3); }

}  // namespace

void JumpGraph::scan_straight(Spot from, int direction, std::vector<Edge>& edges, View& view) const {
  const bool along_x = (direction & 1) == 0;
  const int line = along_x ? from.y : from.x;
  const int begin = along_x ? from.x : from.y;
  if (!leads_[direction].test(line, begin)) return;
  const BitLines& stops = stops_[direction];
  const auto end = static_cast<std::uint16_t>(direction < 2 ? stops.next(line, begin) : stops.previous(line, begin));
  const Spot at = along_x ? Spot{end, from.y} : Spot{from.x, end};
  view.low = {std::min(view.low.x, at.x), std::min(view.low.y, at.y)};
  view.high = {std::max(view.high.x, at.x), std::max(view.high.y, at.y)};
  const NodeId id = id_at(at);
  edges.push_back({id, at, nodes_[id].onward[direction]});
}

bool JumpGraph::scan_diagonal(Spot& at, int part, int steps, std::vector<Edge>& edges, View& view) const {
  const int first = part - 4;
  const int second = (first + 1) & 3;
  const BitLines& leads_x = leads_[(first & 1) != 0 ? second : first];
  const BitLines& leads_y = leads_[(first & 1) != 0 ? first : second];
  const int dx = kDx[part];
  const int dy = kDy[part];
  int x = at.x;
  int y = at.y;
  // Of the square that a diagonal step crosses, the lower left cell.
  const int left = dx < 0 ? -1 : 0;
  const int low = dy < 0 ? -1 : 0;
  bool is_open = true;
  for (; steps > 0 && (is_open = squares_.test(y + low, x + left)); --steps) {
    x += dx;
    y += dy;
    const bool to_x = leads_x.test(y, x);
    const bool to_y = leads_y.test(x, y);
    if (!to_x && !to_y) continue;
    const Spot here{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)};
    scan_straight(here, first, edges, view);
    scan_straight(here, second, edges, view);
  }
  at = {static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)};
  return is_open;
}

int JumpGraph::diagonal_run(Spot from, int part, int most) const {
  const int dx = kDx[part];
  const int dy = kDy[part];
  int x = from.x - (dx < 0);
  int y = from.y - (dy < 0);
  int run = 0;
  for (; run < most && squares_.test(y, x); ++run, x += dx, y += dy) {
  }
  return run;
}

bool JumpGraph::is_direct(Spot from, Spot to) const {
  const int quadrant = quadrant_of(to.x - from.x, to.y - from.y);
  const int both = std::min(std::abs(to.x - from.x), std::abs(to.y - from.y));
  View view;
  view.diagonal[quadrant] = static_cast<std::uint16_t>(diagonal_run(from, 4 + quadrant, both));
  return is_direct(from, view, to);
}

bool JumpGraph::is_direct(Spot from, const View& view, Spot to) const {
  const int dx = to.x - from.x;
  const int dy = to.y - from.y;
  const int both = std::min(std::abs(dx), std::abs(dy));
  if (both > view.diagonal[quadrant_of(dx, dy)]) return false;
  const int x = from.x + (dx >= 0 ? both : -both);
  const int y = from.y + (dy >= 0 ? both : -both);
  if (x == to.x) return grid_.columns().all(x, std::min(y, int{to.y}), std::max(y, int{to.y}));
  return grid_.rows().all(y, std::min(x, int{to.x}), std::max(x, int{to.x}));
}

}  // namespace concord
