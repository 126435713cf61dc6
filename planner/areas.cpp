#include "planner/areas.hpp"

#include <algorithm>

namespace concord {
namespace {

bool has_any(const BrickMap& cells, Cell tile) {
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      if (cells.find(BrickIndex{tile.x * 8 + x, tile.y * 8 + y, 0}) != nullptr) return true;
    }
  }
  return false;
}

}  // namespace

void Areas::follow(const Grid& grid, BrickIndex column) {
  const Cell tile{column.x >> 3, column.y >> 3};
  const bool was_there = tiles_.contains(tile);
  const bool is_there = grid.cells().find(column) != nullptr || (was_there && has_any(grid.cells(), tile));
  if (is_there == was_there) return;
  is_joined_ = false;
  if (is_there) {
    tiles_.insert(tile);
  } else {
    tiles_.erase(tile);
  }
}

/// Areas are told apart by number only, so that the order they are found in does not matter.
void Areas::join() {
  area_.clear();
  rectangles_.clear();
  std::vector<Cell> left;
  for (const Cell first : tiles_) {
    if (!area_.emplace(first, rectangles_.size()).second) continue;
    CellRectangle around{first, first};
    left.push_back(first);
    while (!left.empty()) {
      const Cell tile = left.back();
      left.pop_back();
      around.low = {std::min(around.low.x, tile.x), std::min(around.low.y, tile.y)};
      around.high = {std::max(around.high.x, tile.x), std::max(around.high.y, tile.y)};
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const Cell next{tile.x + dx, tile.y + dy};
          if (tiles_.contains(next) && area_.emplace(next, rectangles_.size()).second) left.push_back(next);
        }
      }
    }
    rectangles_.push_back({{around.low.x * kTile, around.low.y * kTile},
                           {around.high.x * kTile + kTile - 1, around.high.y * kTile + kTile - 1}});
  }
  is_joined_ = true;
}

std::optional<CellRectangle> Areas::around(Cell cell) {
  if (!is_joined_) join();
  const auto it = area_.find(tile_of(cell));
  return it != area_.end() ? std::optional(rectangles_[it->second]) : std::nullopt;
}

bool Areas::together(Cell a, Cell b) {
  if (!is_joined_) join();
  const auto at = area_.find(tile_of(a));
  const auto other = area_.find(tile_of(b));
  return at != area_.end() && other != area_.end() && at->second == other->second;
}

}  // namespace concord
