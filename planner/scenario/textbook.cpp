#include "planner/scenario/textbook.hpp"

#include <array>
#include <queue>

#include "planner/search/octile.hpp"

namespace concord {
namespace {

struct Entry {
  std::int64_t total, left;
  std::int32_t cell;

  bool operator<(const Entry& other) const { return total != other.total ? total > other.total : left > other.left; }
};

constexpr std::array<std::array<int, 2>, 8> kSteps{
    {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};

}  // namespace

TextbookAStar::TextbookAStar(const OpenGrid& grid) : width_(grid.width()), height_(grid.height()) {
  const std::size_t cells = static_cast<std::size_t>(width_) * height_;
  open_.resize(cells);
  nodes_.resize(cells);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) open_[static_cast<std::size_t>(y) * width_ + x] = grid.is_open({x, y}) ? 1 : 0;
  }
}

std::optional<std::int64_t> TextbookAStar::find(Cell start, Cell goal) {
  const auto is_open = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < width_ && y < height_ && open_[static_cast<std::size_t>(y) * width_ + x] != 0;
  };
  if (!is_open(start.x, start.y) || !is_open(goal.x, goal.y)) return std::nullopt;
  ++query_;
  std::priority_queue<Entry> queue;
  const auto reach = [&](int x, int y, std::int64_t cost, std::int32_t parent) {
    const std::int32_t cell = y * width_ + x;
    Node& node = nodes_[static_cast<std::size_t>(cell)];
    if (node.query == query_ && (node.is_closed || cost >= node.cost)) return;
    node = {cost, query_, parent, false};
    const std::int64_t left = octile({x, y}, goal);
    queue.push({cost + left, left, cell});
  };
  reach(start.x, start.y, 0, -1);
  while (!queue.empty()) {
    const std::int32_t cell = queue.top().cell;
    queue.pop();
    Node& node = nodes_[static_cast<std::size_t>(cell)];
    if (node.is_closed) continue;
    node.is_closed = true;
    const int x = cell % width_;
    const int y = cell / width_;
    if (x == goal.x && y == goal.y) return node.cost;
    for (const auto& [dx, dy] : kSteps) {
      if (!is_open(x + dx, y + dy)) continue;
      const bool is_diagonal = dx != 0 && dy != 0;
      if (is_diagonal && (!is_open(x + dx, y) || !is_open(x, y + dy))) continue;
      reach(x + dx, y + dy, node.cost + (is_diagonal ? kDiagonal : kStraight), cell);
    }
  }
  return std::nullopt;
}

}  // namespace concord
