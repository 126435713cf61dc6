#pragma once

#include <cstdint>
#include <unordered_map>

#include "planner/grid.hpp"

namespace concord {

/// Where a change of the grid can change what a search found: a set of columns of bricks and all within `margin` cells.
class Region {
 public:
  explicit Region(int margin = 0) : margin_((margin + kBrickSide - 1) / kBrickSide) {}

  void add(Cell cell) {
    add({cell.x >> 6, cell.y >> 6}, std::uint64_t{1} << ((cell.x >> 3 & 7) | (cell.y >> 3 & 7) << 3));
  }
  /// Columns of one tile of 64 x 64 cells: bit x + 8 y is one column.
  void add(Cell tile, std::uint64_t columns) { tiles_[tile] |= columns; }

  [[nodiscard]] bool is_near(BrickIndex column) const;

 private:
  int margin_;  ///< bricks
  std::unordered_map<Cell, std::uint64_t, CellHash> tiles_;
};

}  // namespace concord
