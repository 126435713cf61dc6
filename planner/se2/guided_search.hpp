#pragma once

#include <functional>
#include <optional>

#include "planner/se2/guide.hpp"
#include "planner/se2/motion.hpp"
#include "planner/se2/steering.hpp"

namespace concord {

/// How much a search may take. `stop` is asked again and again; once it says yes there is no result.
struct SearchEffort {
  std::int64_t most = 0;  ///< steps: poses that are looked at
  std::function<bool()> stop = [] { return false; };
};

struct FoundMotions {
  std::vector<Motion> motions;  ///< none where it found no way
  std::int64_t steps = 0;
  bool stopped = false;
};

/// A* over a guide's poses, joined by what `steering` makes of two; a motion is checked when the search comes to it.
/// Ties go to what was found first.
[[nodiscard]] FoundMotions search_along(const Guide& guide, const StandingRoom& room, const Steering& steering,
                                        const MotionCost& cost, const SearchEffort& effort);

}  // namespace concord
