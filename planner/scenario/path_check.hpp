#pragma once

#include <vector>

#include "planner/lattice/open_grid.hpp"

namespace concord {

/// Whether a polyline over cell centres touches open cells only. By other means than the searches: each cell near a
/// segment is held against it as a closed square, one by one.
[[nodiscard]] bool stays_in_open_cells(const OpenGrid& grid, const std::vector<Cell>& turns);

}  // namespace concord
