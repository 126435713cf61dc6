#pragma once

#include "planner/se2/guided_search.hpp"

namespace concord {

/// Replaces stretches by what `steering` makes of their ends, where that costs less and has room, until nothing is
/// gained or the effort is spent. The result costs no more, has room if the motions had, and has the same ends.
[[nodiscard]] FoundMotions shorten(const std::vector<Motion>& motions, const StandingRoom& room,
                                   const Steering& steering, const MotionCost& cost, const SearchEffort& effort);

}  // namespace concord
