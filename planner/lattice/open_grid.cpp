#include "planner/lattice/open_grid.hpp"

#include <cassert>

namespace concord {

OpenGrid::OpenGrid(int width, int height)
    : width_(width), height_(height), rows_(height + 2, width + 2, false), columns_(width + 2, height + 2, false) {
  assert(width >= 1 && height >= 1 && width <= kMaxSide && height <= kMaxSide);
  assert(std::int64_t{width} * height <= kMaxCells);
}

}  // namespace concord
