#include "planner/search/jump_graph.hpp"

#include <algorithm>
#include <cassert>

namespace concord {
namespace {

/// Directions next to `d`, counter-clockwise and clockwise.
constexpr int left_of(int d) { return (d + 1) & 3; }
constexpr int right_of(int d) { return (d + 3) & 3; }

Spot step(Spot at, int direction) {
  return {static_cast<std::uint16_t>(at.x + kDx[direction]), static_cast<std::uint16_t>(at.y + kDy[direction])};
}

/// A word of a line, moved by one cell up (towards higher bits) or down.
std::uint64_t moved_up(const std::uint64_t* line, int w) { return line[w] << 1 | (w > 0 ? line[w - 1] >> 63 : 0); }
std::uint64_t moved_down(const std::uint64_t* line, int w, int words) {
  return line[w] >> 1 | (w + 1 < words ? line[w + 1] << 63 : 0);
}

}  // namespace

JumpGraph::JumpGraph(const OpenGrid& grid) : grid_(grid), tiles_per_row_((grid.width() + 2 + kTile - 1) / kTile) {
  for (int d = 0; d < 4; ++d) {
    const bool along_x = (d & 1) == 0;
    stops_[d] = along_x ? BitLines(grid.height() + 2, grid.width() + 2, true)
                        : BitLines(grid.width() + 2, grid.height() + 2, true);
    leads_[d] = along_x ? BitLines(grid.height() + 2, grid.width() + 2, false)
                        : BitLines(grid.width() + 2, grid.height() + 2, false);
  }
  squares_ = BitLines(grid.height() + 2, grid.width() + 2, false);
  ids_.resize(static_cast<std::size_t>(tiles_per_row_) * ((grid.height() + 2 + kTile - 1) / kTile));
  const int row_words = grid.rows().words();
  for (int y = 1; y <= grid.height(); ++y) {
    find_stops(0, y, 0, row_words - 1);
    find_leads(0, y);
    find_squares(y, 0, row_words - 1);
  }
  for (int x = 1; x <= grid.width(); ++x) {
    find_stops(1, x, 0, grid.columns().words() - 1);
    find_leads(1, x);
  }
  // Every jump point is one for a horizontal and for a vertical run.
  for (int y = 1; y <= grid.height(); ++y) {
    for (int w = 0; w < grid.rows().words(); ++w) {
      std::uint64_t bits = (stops_[0].line(y)[w] | stops_[2].line(y)[w]) & grid.rows().line(y)[w];
      for (; bits != 0; bits &= bits - 1) {
        settle({static_cast<std::uint16_t>(w << 6 | std::countr_zero(bits)), static_cast<std::uint16_t>(y)});
      }
    }
  }
}

void JumpGraph::find_stops(int axis, int line, int first_word, int last_word) {
  const BitLines& open = axis == 0 ? grid_.rows() : grid_.columns();
  const std::uint64_t* here = open.line(line);
  const std::array<const std::uint64_t*, 2> sides{open.line(line + 1), open.line(line - 1)};
  std::uint64_t* ahead = stops_[axis].line(line);
  std::uint64_t* back = stops_[axis + 2].line(line);
  const int words = open.words();
  for (int w = first_word; w <= last_word; ++w) {
    std::uint64_t up = 0;
    std::uint64_t down = 0;
    for (const std::uint64_t* side : sides) {
      up |= side[w] & ~moved_up(side, w);
      down |= side[w] & ~moved_down(side, w, words);
    }
    ahead[w] = ~here[w] | (up & moved_up(here, w));
    back[w] = ~here[w] | (down & moved_down(here, w, words));
  }
}

/// The whole line: a change is felt as far as the next stops.
void JumpGraph::find_leads(int axis, int line) {
  const BitLines& open = axis == 0 ? grid_.rows() : grid_.columns();
  for (const int direction : {axis, axis + 2}) {
    const std::uint64_t* stops = stops_[direction].line(line);
    const std::uint64_t* here = open.line(line);
    std::uint64_t* leads = leads_[direction].line(line);
    std::fill_n(leads, open.words(), 0);
    for (int w = 0; w < open.words(); ++w) {
      for (std::uint64_t jumps = stops[w] & here[w]; jumps != 0; jumps &= jumps - 1) {
        const int at = w << 6 | std::countr_zero(jumps);
        // From the stop before up to the jump point; a jump point leads on to the next, a blocked cell is never asked.
        if (direction < 2) {
          leads_[direction].fill(line, stops_[direction].previous(line, at), at - 1);
        } else {
          leads_[direction].fill(line, at + 1, stops_[direction].next(line, at));
        }
      }
    }
  }
}

void JumpGraph::find_squares(int line, int first_word, int last_word) {
  const std::uint64_t* here = grid_.rows().line(line);
  const std::uint64_t* above = grid_.rows().line(line + 1);
  const int words = grid_.rows().words();
  std::uint64_t* squares = squares_.line(line);
  for (int w = first_word; w <= last_word; ++w) {
    squares[w] = here[w] & above[w] & moved_down(here, w, words) & moved_down(above, w, words);
  }
}

std::array<JumpGraph::Parts, 4> JumpGraph::onward_at(Spot at) const {
  const BitLines& rows = grid_.rows();
  const auto is_open = [&](Spot s) { return rows.test(s.y, s.x); };
  std::array<Parts, 4> onward{};
  if (!is_open(at)) return onward;
  for (int d = 0; d < 4; ++d) {
    const Spot before = step(at, (d + 2) & 3);
    if (!is_open(before)) continue;
    const int left = left_of(d);
    const int right = right_of(d);
    if (is_open(step(at, left)) && !is_open(step(before, left))) onward[d] |= 1U << left | 1U << (4 + d);
    if (is_open(step(at, right)) && !is_open(step(before, right))) onward[d] |= 1U << right | 1U << (4 + right);
    if (onward[d] != 0) onward[d] |= 1U << d;
  }
  return onward;
}

JumpGraph::NodeId& JumpGraph::id_at(Spot at) const {
  return (*ids_[static_cast<std::size_t>(at.y / kTile) * tiles_per_row_ + at.x / kTile])[at.y % kTile * kTile +
                                                                                         at.x % kTile];
}

/// Makes the spot the jump point that it is now, or none.
void JumpGraph::settle(Spot at) {
  const std::array<Parts, 4> onward = onward_at(at);
  const Parts parts = onward[0] | onward[1] | onward[2] | onward[3];
  std::unique_ptr<Ids>& tile = ids_[static_cast<std::size_t>(at.y / kTile) * tiles_per_row_ + at.x / kTile];
  if (tile == nullptr) {
    if (parts == 0) return;
    tile = std::make_unique<Ids>();
    tile->fill(kNone);
  }
  NodeId& id = id_at(at);
  if (id == kNone && parts == 0) return;
  if (id == kNone) {
    if (unused_.empty()) {
      id = static_cast<NodeId>(nodes_.size());
      nodes_.emplace_back();
    } else {
      id = unused_.back();
      unused_.pop_back();
    }
  }
  Node& node = nodes_[id];
  if (node.is_listed) garbage_ += node.begin[8];
  node = {};
  node.at = at;
  node.onward = onward;
  node.parts = parts;
  if (parts == 0) {
    unused_.push_back(id);
    id = kNone;
  }
}

/// Where runs through bits `first` to `last` of a line begin and end, both ways.
void JumpGraph::widen(int axis, int line, int first, int last, int& low, int& high) const {
  for (const int direction : {axis, axis + 2}) {
    if (first > 0) low = std::min(low, stops_[direction].previous(line, first));
    high = std::max(high, stops_[direction].next(line, last));
  }
}

void JumpGraph::update(const Window& window) {
  // A cell matters to the jump points around it, and these to whatever runs lead to them.
  const int x0 = std::max(window.low.x, 0);
  const int y0 = std::max(window.low.y, 0);
  const int x1 = std::min(window.high.x, grid_.width() - 1) + 2;
  const int y1 = std::min(window.high.y, grid_.height() - 1) + 2;
  if (x0 + 2 > x1 || y0 + 2 > y1) return;
  Box across{x0, y0, x1, y1};
  Box along = across;
  for (int y = std::max(y0, 1); y <= std::min(y1, grid_.height()); ++y) {
    widen(0, y, x0, std::min(x1, grid_.width()), across.x0, across.x1);
    find_stops(0, y, x0 >> 6, x1 >> 6);
    widen(0, y, x0, std::min(x1, grid_.width()), across.x0, across.x1);
    find_leads(0, y);
    find_squares(y, x0 >> 6, x1 >> 6);
  }
  for (int x = std::max(x0, 1); x <= std::min(x1, grid_.width()); ++x) {
    widen(1, x, y0, std::min(y1, grid_.height()), along.y0, along.y1);
    find_stops(1, x, y0 >> 6, y1 >> 6);
    widen(1, x, y0, std::min(y1, grid_.height()), along.y0, along.y1);
    find_leads(1, x);
  }
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) settle({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)});
  }
  for (Node& node : nodes_) {
    if (!node.is_listed || !(across.meets(node.view) || along.meets(node.view))) continue;
    node.is_listed = false;
    garbage_ += node.begin[8];
  }
  if (garbage_ > edges_.size() / 2 + 65'536) compact();
}

void JumpGraph::compact() {
  std::vector<Edge> kept;
  kept.reserve(edges_.size() - garbage_);
  for (Node& node : nodes_) {
    if (!node.is_listed) continue;
    const auto from = edges_.begin() + node.first;
    node.first = static_cast<std::uint32_t>(kept.size());
    kept.insert(kept.end(), from, from + node.begin[8]);
  }
  edges_ = std::move(kept);
  garbage_ = 0;
}

void JumpGraph::complete() {
  for (Node& node : nodes_) {
    if (node.parts != 0 && !node.is_listed) list(node);
  }
}

void JumpGraph::list(Node& node) {
  node.first = static_cast<std::uint32_t>(edges_.size());
  node.view = {{}, node.at, node.at};
  for (int part = 0; part < 8; ++part) {
    node.begin[part] = static_cast<std::uint32_t>(edges_.size()) - node.first;
    if ((node.parts >> part & 1) != 0) scan(node, part);
  }
  node.begin[8] = static_cast<std::uint32_t>(edges_.size()) - node.first;
  node.is_listed = true;
}

void JumpGraph::scan(Node& node, int part) {
  if (part < 4) {
    scan_straight(node.at, part, edges_, node.view);
    return;
  }
  Spot at = node.at;
  scan_diagonal(at, part, OpenGrid::kMaxSide, edges_, node.view);
  View& view = node.view;
  view.diagonal[part - 4] = static_cast<std::uint16_t>(std::abs(at.x - node.at.x));
  // The step that ended it looked one further.
  const Spot last = step(at, part);
  view.low = {std::min(view.low.x, last.x), std::min(view.low.y, last.y)};
  view.high = {std::max(view.high.x, last.x), std::max(view.high.y, last.y)};
}

}  // namespace concord
