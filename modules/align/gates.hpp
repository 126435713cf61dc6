#pragma once

#include <string>

#include "align/evidence.hpp"
#include "core/alignment.hpp"

namespace concord {

/// Surface points below which a map is none: two square metres at 10 cm.
inline constexpr std::size_t kMinSurfacePoints = 200;

/// How a place came to be looked at. Among thousands of places some fit by chance: without a guess more is asked.
enum class Origin { kGuess, kAnywhere };

struct GateAnswer {
  AlignReason reason = AlignReason::kAccepted;
  std::string message;  ///< which gate was not passed, by how much, and what to do; empty where all were
};

/// What a place must show to be believed, were it the only one: kAccepted, kLowOverlap, kDegenerate or kDiverged.
[[nodiscard]] GateAnswer check_gates(const Support& support, Origin origin);

/// Whether a place that is contradicted is to be believed for what is left without the things that were moved: enough
/// walls, and next to nothing against them. Two things are all the furniture that many a room has.
[[nodiscard]] bool agrees_but_for_moved_things(const Support& rest);

/// Whether a place, roughly refined, may turn out to be a rival.
[[nodiscard]] bool may_rival(const Support& rough);
/// Whether a refined place speaks against another one that passed the gates: enough overlap, and little against it, or
/// hardly more than against the other; however loosely it is held. Where nobody said which, five times as much as is
/// against the other: in a row of offices each has its chairs elsewhere.
[[nodiscard]] bool is_rival(const Support& place, const Support& accepted, Origin origin);

/// Whether a place may be that of a mirror image: in a room, below what is a building, a few percent of the walls are
/// all that tells the two apart; and where hardly anything is against the source, no mirror image lies better.
[[nodiscard]] bool may_be_mirrored(const Support& accepted);
/// Whether the source's mirror image lies better in the target than the source itself does: one of the two is
/// mirrored, or they are two rooms of one plan.
[[nodiscard]] bool is_better_mirrored(const Support& mirrored, const Support& accepted);
/// Of both what is left without moved things: nearly as good is too good, since what told them apart may be taken out.
[[nodiscard]] bool is_as_good_mirrored(const Support& mirrored_rest, const Support& accepted_rest);

/// Which of two places to look at first: those with enough overlap, then by score.
[[nodiscard]] bool ranks_before(const Support& a, const Support& b);

/// Whether a place that was moved from a good one is as good: what speaks against it must rise by a fiftieth of what
/// the maps can tell, and by a square metre, else nothing holds the source there. Along the ground and in turns walls
/// are asked, in height everything.
[[nodiscard]] bool is_as_good(const Support& moved, const Support& good);
/// Whether next to nothing is left against a moved place once the thing that speaks most against it is taken out: what
/// people move is all that holds the source there.
[[nodiscard]] bool is_held_by_a_thing(const Support& moved_rest, const Support& good);
[[nodiscard]] bool is_as_good_in_height(const Support& moved, const Support& good);

}  // namespace concord
