#pragma once

#include <functional>

#include "planner/lattice/cell.hpp"

namespace concord {

/// What else decides whether a straight line between the centres of two open cells can be gone: a robot's disc may fit
/// at the centres of all cells that a line touches, and not between.
using SightRule = std::function<bool(Cell from, Cell to)>;

}  // namespace concord
