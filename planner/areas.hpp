#pragma once

#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "planner/zone_cells.hpp"

namespace concord {

/// Which parts of the grid can hang together at all: tiles of 64 x 64 cells with anything known in them, joined where
/// they touch. What lies far off and alone makes no rectangle larger that is worked on.
class Areas {
 public:
  static constexpr int kTile = 64;

  /// These columns of bricks have changed, or may have.
  void follow(const Grid& grid, BrickIndex column);

  /// The rectangle of tiles around the area that the cell lies in; nothing where nothing is known about.
  [[nodiscard]] std::optional<CellRectangle> around(Cell cell);
  /// Whether both lie in one area: if not, no known cells lead from one to the other.
  [[nodiscard]] bool together(Cell a, Cell b);

 private:
  static Cell tile_of(Cell cell) { return {cell.x >> 6, cell.y >> 6}; }
  void join();

  std::unordered_set<Cell, CellHash> tiles_;
  std::unordered_map<Cell, std::size_t, CellHash> area_;  ///< of each tile, if is_joined_
  std::vector<CellRectangle> rectangles_;                 ///< by area
  bool is_joined_ = true;
};

}  // namespace concord
