#include "align/gates.hpp"

#include <algorithm>
#include <cstdio>

namespace concord {
namespace {

struct Gates {
  double min_overlap;  ///< of the map that is covered better
  double min_upright;  ///< square metres of walls that lie on walls, both ways
};
constexpr Gates kWithGuess{0.30, 5.0};
constexpr Gates kWithoutGuess{0.40, 12.0};

/// Share against, of walls: in a room a few percent are all the furniture that tells it from its mirror image; in a
/// building one piece of furniture is no longer all that tells places apart, and slow drift adds up.
constexpr double kMaxAgainstRoom = 0.025;
constexpr double kMaxAgainstBuilding = 0.10;
/// Of it what stands in free space: people and doors move, walls do not.
constexpr double kMaxContradictedRoom = 0.03;
constexpr double kMaxContradictedBuilding = 0.06;
constexpr double kRoomWalls = 100.0;  // square metres, both ways
constexpr double kBuildingWalls = 300.0;

constexpr double kMinLevel = 1.0;  // square metres of floor or ceiling that lie right, both ways
constexpr double kLevelsThatHold =
    0.1;                          // of the walls that lie right: fewer floors and ceilings are not asked about height
constexpr double kMinRise = 1.0;  // square metres
constexpr double kMinShareRise = 0.02;
constexpr double kMinRiseWithoutThing = 0.3;  // square metres
constexpr double kMaxLevelAgainst = 0.15;
/// Of all that lies right: where a map has hardly any floor, what is called level is edges of other things.
constexpr double kFewAgainst = 0.02;
/// A rival: less against it than this, than it might have to be accepted, or than is against the answer and a little.
constexpr double kPlausibleAgainst = 0.05;
constexpr double kPlausibleTimes = 5.0;  // as much as is against the answer, where nobody said which place
constexpr double kMostPlausible = 0.10;
constexpr double kMoreAgainst = 0.02;
constexpr double kMoreLevelAgainst = 0.04;
/// Refinement takes some of what speaks against a rough place away.
constexpr double kRoughAgainst = 0.15;
constexpr double kRoughLevelAgainst = 0.25;
constexpr double kMirrorAgainst = 0.004;
constexpr double kMirrorWalls =
    2000.0;  // square metres, both ways: a hall of 60 x 40 m; beyond it are floors of buildings
/// By how much a mirror image must be better: what noise makes of two that are as good.
constexpr double kMirroredShare = 1.02;
constexpr double kMirroredMore = 1.0;  // square metres

/// The right place of a mirror image may have less in common than the wrong one that was found, but hardly anything
/// against it.
constexpr double kMirroredWalls = 0.5;    // of those that lie right in the place that was found
constexpr double kMirroredAgainst = 0.5;  // of what is against there

/// What is left without moved things. Of right places up to 0.1 % was against; where it was of wrong ones, up to 35 m2
/// of walls lay on each other, halves of small rooms, or a mirror image was as good.
constexpr double kMaxRestAgainst = 0.001;
constexpr double kMinRestWalls = 40.0;  // square metres, both ways
constexpr double kMaxMirroredRestAgainst = 0.002;

const Gates& gates_for(Origin origin) { return origin == Origin::kGuess ? kWithGuess : kWithoutGuess; }

double overlap(const Support& s) { return std::max(s.overlap_source(), s.overlap_target()); }

/// Between what holds for a room and for a building.
double between(double room, double building, double walls) {
  return room + std::clamp((walls - kRoomWalls) / (kBuildingWalls - kRoomWalls), 0.0, 1.0) * (building - room);
}

double contradicted_share(const Verdicts& v) {
  return v.matched + v.contradicted > 0.0 ? v.contradicted / (v.matched + v.contradicted) : 0.0;
}

bool has_enough_walls(const Support& mirrored, const Support& found) {
  return mirrored.upright().matched >= kMirroredWalls * found.upright().matched;
}

/// Whether floors and ceilings say that the heights are wrong.
bool levels_contradict(const Support& s) {
  const Verdicts level = s.level();
  return level.share_against() > kMaxLevelAgainst &&
         level.against() > kFewAgainst * (s.upright().matched + level.matched);
}

std::string percent(double share) {
  char text[16];
  std::snprintf(text, sizeof text, "%.1f %%", 100.0 * share);
  return text;
}

std::string of_allowed(double share, double allowed) { return percent(share) + ", " + percent(allowed) + " allowed"; }

GateAnswer low_overlap(const std::string& what) {
  return {AlignReason::kLowOverlap, what + "; map more of what both have seen, or guess where it lies"};
}

GateAnswer diverged(const std::string& what) {
  return {AlignReason::kDiverged,
          "the maps contradict each other there: " + what + "; guess better where it lies, or map what was moved anew"};
}

bool rises(const Verdicts& there, const Verdicts& here) {
  return there.against() >= here.against() + kMinRise && there.share_against() >= here.share_against() + kMinShareRise;
}

}  // namespace

GateAnswer check_gates(const Support& s, Origin origin) {
  const Gates& gates = gates_for(origin);
  const Verdicts upright = s.upright();
  const double walls = upright.matched;
  if (overlap(s) < gates.min_overlap) {
    return low_overlap("only " + percent(overlap(s)) + " of either map lies on the other, " +
                       percent(gates.min_overlap) + " asked");
  }
  if (walls < gates.min_upright) {
    return low_overlap("only " + std::to_string(walls).substr(0, 4) + " m2 of walls lie on each other, " +
                       std::to_string(gates.min_upright).substr(0, 4) + " asked");
  }
  const double max_against = between(kMaxAgainstRoom, kMaxAgainstBuilding, walls);
  if (upright.share_against() > max_against) {
    return diverged("of the walls that both can tell of " + of_allowed(upright.share_against(), max_against));
  }
  const double max_contradicted = between(kMaxContradictedRoom, kMaxContradictedBuilding, walls);
  if (contradicted_share(upright) > max_contradicted) {
    return diverged("walls where the other saw nothing, " + of_allowed(contradicted_share(upright), max_contradicted));
  }
  if (levels_contradict(s)) {
    return diverged("of floors and ceilings " + of_allowed(s.level().share_against(), kMaxLevelAgainst));
  }
  if (s.level().matched < kMinLevel) {
    return {AlignReason::kDegenerate, "no floor or ceiling that both have seen holds the height; map some"};
  }
  if (s.is_contested()) return diverged("most walls that face one way lie wrong");
  return {};
}

bool agrees_but_for_moved_things(const Support& rest) {
  const Verdicts upright = rest.upright();
  return upright.matched >= kMinRestWalls && upright.share_against() <= kMaxRestAgainst &&
         check_gates(rest, Origin::kGuess).reason == AlignReason::kAccepted;
}

bool may_rival(const Support& rough) {
  return overlap(rough) >= kWithGuess.min_overlap && rough.upright().share_against() <= kRoughAgainst &&
         rough.level().share_against() <= kRoughLevelAgainst;
}

bool is_rival(const Support& place, const Support& accepted, Origin origin) {
  const Verdicts upright = place.upright();
  double plausible = kPlausibleAgainst;
  if (origin == Origin::kAnywhere) {
    const double times = kPlausibleTimes * accepted.upright().share_against();
    plausible = std::clamp(times, kPlausibleAgainst, kMostPlausible);
  }
  const double walls = std::max({plausible, accepted.upright().share_against() + kMoreAgainst,
                                 between(kMaxAgainstRoom, kMaxAgainstBuilding, upright.matched)});
  const double levels = std::max(kMaxLevelAgainst, accepted.level().share_against() + kMoreLevelAgainst);
  return overlap(place) >= kWithGuess.min_overlap && upright.share_against() <= walls &&
         place.level().share_against() <= levels;
}

bool may_be_mirrored(const Support& accepted) {
  return accepted.upright().matched <= kMirrorWalls && accepted.upright().share_against() >= kMirrorAgainst;
}

bool is_better_mirrored(const Support& mirrored, const Support& accepted) {
  if (overlap(mirrored) < kWithGuess.min_overlap) return false;
  return mirrored.score() > kMirroredShare * accepted.score() + kMirroredMore ||
         (has_enough_walls(mirrored, accepted) &&
          mirrored.upright().share_against() < kMirroredAgainst * accepted.upright().share_against());
}

bool is_as_good_mirrored(const Support& mirrored_rest, const Support& accepted_rest) {
  return overlap(mirrored_rest) >= kWithGuess.min_overlap && has_enough_walls(mirrored_rest, accepted_rest) &&
         mirrored_rest.upright().share_against() <= kMaxMirroredRestAgainst;
}

bool ranks_before(const Support& a, const Support& b) {
  const bool first = overlap(a) >= kWithGuess.min_overlap;
  const bool second = overlap(b) >= kWithGuess.min_overlap;
  return first != second ? first : a.score() > b.score();
}

bool is_as_good(const Support& moved, const Support& good) {
  return overlap(moved) >= kWithGuess.min_overlap && !rises(moved.upright(), good.upright());
}

bool is_held_by_a_thing(const Support& moved_rest, const Support& good) {
  return overlap(moved_rest) >= kWithGuess.min_overlap &&
         moved_rest.upright().against() < good.upright().against() + kMinRiseWithoutThing;
}

bool is_as_good_in_height(const Support& moved, const Support& good) {
  if (overlap(moved) < kWithGuess.min_overlap) return false;
  // A table that came to lie on a floor holds no height.
  const bool has_levels = good.level().matched >= kLevelsThatHold * good.upright().matched;
  return has_levels ? !rises(moved.all(), good.all()) : !rises(moved.upright(), good.upright());
}

}  // namespace concord
