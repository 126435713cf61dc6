#include "align/gates.hpp"

#include <algorithm>

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
constexpr double kMinRise = 1.0;   // square metres
constexpr double kMinShareRise = 0.02;
constexpr double kMaxLevelAgainst = 0.15;
/// Of all that lies right: where a map has hardly any floor, what is called level is edges of other things.
constexpr double kFewAgainst = 0.02;
constexpr double kPlausibleAgainst = 0.05;
constexpr double kPlausibleLevelAgainst = 0.08;

const Gates& gates_for(Origin origin) { return origin == Origin::kGuess ? kWithGuess : kWithoutGuess; }

double overlap(const Support& s) { return std::max(s.overlap_source(), s.overlap_target()); }

/// Between what holds for a room and for a building.
double between(double room, double building, double walls) {
  return room + std::clamp((walls - kRoomWalls) / (kBuildingWalls - kRoomWalls), 0.0, 1.0) * (building - room);
}

double contradicted_share(const Verdicts& v) {
  return v.matched + v.contradicted > 0.0 ? v.contradicted / (v.matched + v.contradicted) : 0.0;
}

/// Whether floors and ceilings say that the heights are wrong.
bool levels_contradict(const Support& s) {
  const Verdicts level = s.level();
  return level.share_against() > kMaxLevelAgainst &&
         level.against() > kFewAgainst * (s.upright().matched + level.matched);
}

}  // namespace

AlignReason check_gates(const Support& s, Origin origin) {
  const Gates& gates = gates_for(origin);
  const Verdicts upright = s.upright();
  if (overlap(s) < gates.min_overlap || upright.matched < gates.min_upright) return AlignReason::kLowOverlap;
  const double walls = upright.matched;
  if (upright.share_against() > between(kMaxAgainstRoom, kMaxAgainstBuilding, walls) ||
      contradicted_share(upright) > between(kMaxContradictedRoom, kMaxContradictedBuilding, walls) ||
      levels_contradict(s)) {
    return AlignReason::kDiverged;
  }
  if (s.level().matched < kMinLevel) return AlignReason::kDegenerate;
  return s.is_contested() ? AlignReason::kDiverged : AlignReason::kAccepted;
}

bool is_plausible(const Support& s) {
  return overlap(s) >= kWithGuess.min_overlap && s.upright().share_against() <= kPlausibleAgainst &&
         s.level().share_against() <= kPlausibleLevelAgainst;
}

bool ranks_before(const Support& a, const Support& b) {
  const bool first = overlap(a) >= kWithGuess.min_overlap;
  const bool second = overlap(b) >= kWithGuess.min_overlap;
  return first != second ? first : a.score() > b.score();
}

bool is_as_good(const Support& slid, const Support& good) {
  if (overlap(slid) < kWithGuess.min_overlap) return false;
  const Verdicts there = slid.upright();
  const Verdicts here = good.upright();
  return there.against() < here.against() + kMinRise || there.share_against() < here.share_against() + kMinShareRise;
}

}  // namespace concord
