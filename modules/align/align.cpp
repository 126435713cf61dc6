#include "align/align.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <Eigen/Eigenvalues>

#include "align/hypotheses.hpp"

namespace concord {
namespace {

constexpr std::size_t kMinPoints = 200;
constexpr std::size_t kJudgePieces = 20'000;
constexpr std::size_t kRivalPieces = 6000;

constexpr double kMinOverlap = 0.30;
constexpr double kMinHeld = 1.0;  // square metres that face a direction, both ways
constexpr double kMaxUprightAgainst = 0.12;
constexpr double kMaxLevelAgainst = 0.15;
constexpr double kSamePlace = 0.25;  // metres
constexpr double kSameTurn = 3.0 * M_PI / 180.0;

double turn_between(const Transform& a, const Transform& b) {
  return Eigen::AngleAxisd(Eigen::Matrix3d(a.linear().transpose() * b.linear())).angle();
}

/// Whether two transforms put the middle of the source to different places.
bool differ(const Transform& a, const Transform& b, const Eigen::Vector3d& p_source) {
  return (a * p_source - b * p_source).norm() > kSamePlace || turn_between(a, b) > kSameTurn;
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

namespace {

/// What a place must show to be believed, were it the only one.
struct Gates {
  static AlignReason check(const Support& s) {
    if (std::max(s.overlap_source(), s.overlap_target()) < kMinOverlap) return AlignReason::kLowOverlap;
    if (s.least_held().second < kMinHeld) return AlignReason::kDegenerate;
    if (s.level().matched < kMinHeld) return AlignReason::kDegenerate;
    if (s.score() < 0.0 || s.upright().share_against() > kMaxUprightAgainst ||
        s.level().share_against() > kMaxLevelAgainst) {
      return AlignReason::kDiverged;
    }
    return AlignReason::kAccepted;
  }
};

/// Slides the source along the ground from where it was found; a place that passes the gates as well is a rival.
void probe_slides(const AlignMap& target, const AlignMap& source, const GicpResult& fine, const Support& best,
                  int threads, Alignment& out) {
  const Eigen::Vector2d weak = best.least_held().first;
  for (const Eigen::Vector2d& axis : {weak, Eigen::Vector2d(-weak.y(), weak.x())}) {
    const Eigen::Vector3d direction(axis.x(), axis.y(), 0.0);
    for (const double step : {-2.0, -1.0, -0.5, 0.5, 1.0, 2.0}) {
      Transform T = fine.T_target_source;
      T.translation() += step * direction;
      const Support s = support(target, source, T, kRivalPieces, threads);
      if (Gates::check(s) != AlignReason::kAccepted) continue;
      if (s.score() > out.rival_score) {
        out.rival_score = s.score();
        out.T_target_source_rival = T;
      }
      const std::string words = name_slide(direction);
      if (std::find(out.loose.begin(), out.loose.end(), words) == out.loose.end()) out.loose.push_back(words);
    }
  }
}

void judge(const AlignMap& target, const AlignMap& source, const GicpResult& fine, int threads, Alignment& out) {
  out.T_target_source = fine.T_target_source;
  out.rms = fine.rms;
  out.covariance = covariance(fine);
  const Support s = support(target, source, fine.T_target_source, kJudgePieces, threads);
  out.overlap_source = s.overlap_source();
  out.overlap_target = s.overlap_target();
  out.contradiction_upright = s.upright().share_against();
  out.contradiction_level = s.level().share_against();
  out.score = s.score();
  const auto [weak, held] = s.least_held();
  if (held < kMinHeld) out.loose.push_back(name_slide({weak.x(), weak.y(), 0.0}));
  if (s.level().matched < kMinHeld) out.loose.push_back(name_slide(Eigen::Vector3d::UnitZ()));
  out.reason = Gates::check(s);
  if (out.reason != AlignReason::kAccepted) return;
  const bool has_rival = out.rival_score > 0.0;
  probe_slides(target, source, fine, s, threads, out);
  if (!out.loose.empty()) {
    out.reason = AlignReason::kDegenerate;
  } else if (has_rival) {
    out.reason = AlignReason::kAmbiguous;
  }
}

}  // namespace

Alignment align(const AlignMap& target, const AlignMap& source, const std::optional<Transform>& guess, int threads) {
  Alignment out;
  if (target.points.size() < kMinPoints || source.points.size() < kMinPoints) return out;
  const std::vector<Hypothesis> hypotheses = find_hypotheses(target, source, guess, threads);
  out.hypotheses = static_cast<int>(hypotheses.size());
  if (hypotheses.empty()) {
    out.reason = AlignReason::kLowOverlap;
    return out;
  }
  const Transform best = hypotheses.front().T_target_source;
  const GicpResult fine = refine_fully(target, source, best, threads);
  const Eigen::Vector3d p_source = fine.T_target_source.inverse() * fine.p_target_centre;
  for (const Hypothesis& h : hypotheses) {
    out.iterations += h.iterations;
    if (h.score <= out.rival_score || !differ(h.T_target_source, best, p_source)) continue;
    if (Gates::check(support(target, source, h.T_target_source, kRivalPieces, threads)) != AlignReason::kAccepted) {
      continue;
    }
    out.rival_score = h.score;
    out.T_target_source_rival = h.T_target_source;
  }
  out.iterations += fine.iterations;
  judge(target, source, fine, threads, out);
  return out;
}

}  // namespace concord
