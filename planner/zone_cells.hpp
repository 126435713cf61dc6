#pragma once

#include <cstdint>
#include <vector>

#include "core/corrections.hpp"
#include "planner/grid.hpp"

namespace concord {

/// A rectangle of cells, both corners in it.
struct CellRectangle {
  Cell low{0, 0}, high{-1, -1};

  [[nodiscard]] bool holds(Cell cell) const {
    return cell.x >= low.x && cell.x <= high.x && cell.y >= low.y && cell.y <= high.y;
  }
  [[nodiscard]] bool meets(const CellRectangle& other) const {
    return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y && other.low.y <= high.y;
  }
  /// Its cells within a column of bricks; bit x + 8 y.
  [[nodiscard]] std::uint64_t plane(BrickIndex column) const;
};

/// Some cells of one column of bricks: bit x + 8 y.
struct ColumnPlane {
  BrickIndex column;  ///< z = 0
  std::uint64_t cells = 0;
};

/// The cells of the grid that one zone takes.
struct ZoneCells {
  std::int64_t count = 0;
  std::vector<ColumnPlane> columns;  ///< ascending; none is empty
  CellRectangle bounds;              ///< holds all of them

  [[nodiscard]] std::uint64_t plane(BrickIndex column) const;
};

/// The cells whose square the zone touches anywhere in the band, and those nearer to one of them than its margin,
/// square to square. Refused: as by `footprint`; over `most` cells (kTooLarge).
[[nodiscard]] Result<ZoneCells> draw(const Zone& zone, double resolution, const Band& band, std::int64_t most);

/// How many those are, at the cost of their rows; with a margin, no fewer. Refused likewise.
[[nodiscard]] Result<std::int64_t> count(const Zone& zone, double resolution, const Band& band, std::int64_t most);

/// A rectangle along the grid's axes that holds every cell of the map's bounds that the zone touches in the band,
/// whatever the zone, with its margin: all there are where its place cannot be told.
[[nodiscard]] CellRectangle rectangle_around(const Zone& zone, double resolution, const Band& band);

/// Whether both take the same cells in the same way: the same kind, volume, place, margin and cost.
[[nodiscard]] bool same_ground(const Zone& a, const Zone& b);

}  // namespace concord
