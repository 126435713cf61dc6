#include "align/gates.hpp"

#include <algorithm>

namespace concord {
namespace {

constexpr double kMinOverlap = 0.30;
constexpr double kMinHeld = 1.0;   // square metres of surface, both ways, that face a direction
constexpr double kMinScore = 0.5;  // square metres, see Support::score
constexpr double kMaxUprightAgainst = 0.10;
constexpr double kMaxUprightContradicted = 0.03;
constexpr double kMaxLevelAgainst = 0.15;
constexpr double kPlausibleShare = 0.5;

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

AlignReason check_gates(const Support& s) {
  if (overlap(s) < kMinOverlap) return AlignReason::kLowOverlap;
  if (s.upright().share_against() > kMaxUprightAgainst || s.level().share_against() > kMaxLevelAgainst ||
      contradicted_share(s.upright()) > kMaxUprightContradicted) {
    return AlignReason::kDiverged;
  }
  if (!loose_directions(s).empty()) return AlignReason::kDegenerate;
  return s.score() < kMinScore ? AlignReason::kDiverged : AlignReason::kAccepted;
}

bool is_plausible(const Support& s) {
  return overlap(s) >= kMinOverlap && s.upright().share_against() <= kPlausibleShare * kMaxUprightAgainst &&
         s.level().share_against() <= kPlausibleShare * kMaxLevelAgainst;
}

bool ranks_before(const Support& a, const Support& b) {
  const bool first = overlap(a) >= kMinOverlap;
  const bool second = overlap(b) >= kMinOverlap;
  return first != second ? first : a.score() > b.score();
}

std::vector<std::string> loose_directions(const Support& s) {
  std::vector<std::string> out;
  const auto [direction, held] = s.least_held();
  if (held < kMinHeld) out.push_back(name_slide({direction.x(), direction.y(), 0.0}));
  if (s.level().matched < kMinHeld) out.push_back(name_slide(Eigen::Vector3d::UnitZ()));
  return out;
}

}  // namespace concord
