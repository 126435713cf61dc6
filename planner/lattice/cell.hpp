#pragma once

#include <cstdint>

#include "core/brick_map.hpp"

namespace concord {

/// One cell of the 2D grid: [x r, (x + 1) r) x [y r, (y + 1) r) in the map frame.
struct Cell {
  std::int32_t x = 0, y = 0;
  auto operator<=>(const Cell&) const = default;
};

struct CellHash {
  std::size_t operator()(const Cell& c) const { return IndexHash{}(BrickIndex{c.x, c.y, 0}); }
};

/// The cells from `low` to `high`, both in it: where something changed.
struct Window {
  Cell low, high;
  bool operator==(const Window&) const = default;
};

}  // namespace concord
