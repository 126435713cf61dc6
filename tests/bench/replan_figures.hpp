#pragma once

#include <cstddef>
#include <vector>

#include "planner/files/movingai.hpp"
#include "planner/lattice/open_grid.hpp"

namespace concord {

/// What it takes to follow small edits, and what the same search from scratch takes on the same grid. Processor time of
/// the thread, microseconds; both have to bring their distance field up to date first, and that is counted.
struct ReplanFigures {
  std::vector<double> follow_us, scratch_us;  ///< by edit
  std::vector<double> improve_us;             ///< afterwards, when there is time: by edit
  std::size_t improved = 0;
  std::size_t kept = 0, repaired = 0, anew = 0, unreachable = 0;
  std::size_t wrong = 0;  ///< a path where there is none or the other way round, or one that is not open
  double worst_cost = 1;  ///< of the path over that of the one from scratch, after `improve`
};

/// Some of the queries, ten edits each of 3 to 9 cells a side: three of five on the path, two anywhere; one of three
/// opens the cells, two block them.
[[nodiscard]] ReplanFigures replan_figures(const OpenGrid& grid, const std::vector<ScenarioQuery>& queries);

}  // namespace concord
