#include "align/gates.hpp"

#include <algorithm>

namespace concord {
namespace {

struct Gates {
  double min_overlap;  ///< of the map that is covered better
  double min_upright;  ///< square metres of walls that lie on walls, both ways
  double min_held;     ///< square metres of them, both ways, that face a direction
  double max_against;  ///< share against, of walls, where there are few of them
  double
      max_against_big;  ///< and where there are many: one piece of furniture is no longer all that tells places apart
};
constexpr Gates kWithGuess{0.30, 5.0, 1.0, 0.10, 0.10};
constexpr Gates kWithoutGuess{0.40, 20.0, 3.0, 0.04, 0.10};
constexpr double kManyWalls = 100.0;  // square metres, both ways

constexpr double kMinScore = 0.5;  // square metres, see Support::score
constexpr double kMaxContradicted = 0.03;
constexpr double kMaxLevelAgainst = 0.15;
constexpr double kPlausibleAgainst = 0.05;
constexpr double kPlausibleLevelAgainst = 0.08;

const Gates& gates_for(Origin origin) { return origin == Origin::kGuess ? kWithGuess : kWithoutGuess; }

double overlap(const Support& s) { return std::max(s.overlap_source(), s.overlap_target()); }

double contradicted_share(const Verdicts& v) {
  return v.matched + v.contradicted > 0.0 ? v.contradicted / (v.matched + v.contradicted) : 0.0;
}

}  // namespace

const char* name(AlignReason reason) {
  switch (reason) {
    case AlignReason::kAccepted: return "ACCEPTED";
    case AlignReason::kNoMap: return "NO_MAP";
    case AlignReason::kLowOverlap: return "LOW_OVERLAP";
    case AlignReason::kDiverged: return "DIVERGED";
    case AlignReason::kDegenerate: return "DEGENERATE";
    case AlignReason::kAmbiguous: return "AMBIGUOUS";
  }
  return "?";
}

AlignReason check_gates(const Support& s, Origin origin) {
  const Gates& gates = gates_for(origin);
  const Verdicts upright = s.upright();
  if (overlap(s) < gates.min_overlap || upright.matched < gates.min_upright) return AlignReason::kLowOverlap;
  const double max_against = upright.matched < kManyWalls ? gates.max_against : gates.max_against_big;
  if (upright.share_against() > max_against || s.level().share_against() > kMaxLevelAgainst ||
      contradicted_share(upright) > kMaxContradicted) {
    return AlignReason::kDiverged;
  }
  if (!loose_directions(s, origin).empty()) return AlignReason::kDegenerate;
  return s.score() < kMinScore ? AlignReason::kDiverged : AlignReason::kAccepted;
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

std::vector<std::string> loose_directions(const Support& s, Origin origin) {
  const double least = gates_for(origin).min_held;
  std::vector<std::string> out;
  const auto [direction, held] = s.least_held();
  if (held < least) out.push_back(name_slide({direction.x(), direction.y(), 0.0}));
  if (s.level().matched < least) out.push_back(name_slide(Eigen::Vector3d::UnitZ()));
  return out;
}

}  // namespace concord
