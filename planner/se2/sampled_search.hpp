#pragma once

#include <vector>

#include "planner/lattice/open_grid.hpp"
#include "planner/se2/guided_search.hpp"

namespace concord {

/// Where a search that guesses takes its guesses from: around these cells, within `spread` of them (cells).
struct SampleRegion {
  std::vector<Cell> cells;
  double spread = 0;
};

/// A way by sampling: OMPL's RRT-Connect (Kuffner & LaValle 2000) over what `steering` makes of two poses, every motion
/// held against `room`. The same guesses for the same request: they are drawn here, from `seed` alone, and counted.
[[nodiscard]] FoundMotions search_by_samples(const SampleRegion& region, const Pose& start, const Pose& goal,
                                             const StandingRoom& room, const Steering& steering,
                                             const SearchEffort& effort, std::uint64_t seed);

}  // namespace concord
