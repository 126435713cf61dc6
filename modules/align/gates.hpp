#pragma once

#include "align/evidence.hpp"
#include "core/alignment.hpp"

namespace concord {

/// Surface points below which a map is none: two square metres at 10 cm.
inline constexpr std::size_t kMinSurfacePoints = 200;

/// How a place came to be looked at. Among thousands of places some fit by chance: without a guess more is asked.
enum class Origin { kGuess, kAnywhere };

/// What a place must show to be believed, were it the only one: kAccepted, kLowOverlap, kDegenerate or kDiverged.
[[nodiscard]] AlignReason check_gates(const Support& support, Origin origin);

/// Whether a place speaks against another one that passed the gates: enough overlap and too little against it, however
/// loosely it is held.
[[nodiscard]] bool is_plausible(const Support& support);

/// Which of two places to look at first: those with enough overlap, then by score.
[[nodiscard]] bool ranks_before(const Support& a, const Support& b);

/// Whether a place that was slid from a good one is as good: what speaks against it must rise by a fiftieth of what the
/// maps can tell, and by a square metre, else nothing holds the source there.
[[nodiscard]] bool is_as_good(const Support& slid, const Support& good);

}  // namespace concord
