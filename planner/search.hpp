#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner/free_space.hpp"
#include "planner/region.hpp"
#include "planner/search/octile.hpp"

namespace concord {

/// A cell where a path may begin or end, and what it costs to get to it from the exact start (or from it to the goal).
struct Anchor {
  Cell cell;
  std::int64_t cost = 0;
};

struct CellPath {
  enum class Status { kFound, kNone, kGaveUp };
  Status status = Status::kNone;
  std::vector<Cell> cells;  ///< from a start to a goal, each a neighbour of the one before
  std::int64_t cost = 0;    ///< with those of both anchors
  std::int64_t expanded = 0;
  Region reached;  ///< unless found: as long as nothing there becomes free, the same search fails again
};

/// The cheapest path from any start to any goal over open cells, by A*: to the eight neighbours, over a corner only if
/// both cells beside it are open too. Ties go to the cell nearer to the goal, then to the lower y, then the lower x.
/// Gives up after `max_expanded` cells. @pre there are a start and a goal at
/// least, all are open and their costs not negative.
[[nodiscard]] CellPath find_path(FreeSpace& space, std::span<const Anchor> starts, std::span<const Anchor> goals,
                                 std::int64_t max_expanded);

}  // namespace concord
