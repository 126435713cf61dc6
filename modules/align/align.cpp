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
constexpr double kMinUprightArea = 2.0;  // square metres of walls that lie on walls, mean of both ways
constexpr double kMaxUprightContradiction = 0.15;
constexpr double kMaxLevelContradiction = 0.25;
constexpr double kRivalShare = 0.85;
constexpr double kSamePlace = 0.25;  // metres
constexpr double kSameTurn = 3.0 * M_PI / 180.0;
constexpr double kMaxRms = 0.75;  // voxels of the coarser map... in cells of the fine level

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

/// Slides the source along the ground from where it was found; a place that explains as much is a rival.
void probe_slides(const AlignMap& target, const AlignMap& source, const GicpResult& fine, int threads, Alignment& out) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> along(fine.hessian.block<2, 2>(3, 3));
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector3d direction(along.eigenvectors()(0, axis), along.eigenvectors()(1, axis), 0.0);
    for (const double step : {-2.0, -1.0, -0.5, 0.5, 1.0, 2.0}) {
      Transform T = fine.T_target_source;
      T.translation() += step * direction;
      const double score = support(target, source, T, kRivalPieces, threads).score();
      if (score > out.rival_score) {
        out.rival_score = score;
        out.T_target_source_rival = T;
        if (score > kRivalShare * out.score) out.loose.push_back(name_slide(direction));
      }
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
  out.contradiction_upright = s.upright().contradiction();
  out.contradiction_level = s.level().contradiction();
  out.score = support(target, source, fine.T_target_source, kRivalPieces, threads).score();
  for (const LooseDirection& loose : loose_directions(fine)) out.loose.push_back(loose.words);
  probe_slides(target, source, fine, threads, out);
  if (out.overlap() < kMinOverlap || s.upright().matched < 2.0 * kMinUprightArea) {
    out.reason = AlignReason::kLowOverlap;
  } else if (out.contradiction_upright > kMaxUprightContradiction || out.contradiction_level > kMaxLevelContradiction) {
    out.reason = AlignReason::kDiverged;
  } else if (!out.loose.empty()) {
    out.reason = AlignReason::kDegenerate;
  } else if (out.rival_score > kRivalShare * out.score) {
    out.reason = AlignReason::kAmbiguous;
  } else {
    out.reason = AlignReason::kAccepted;
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
  for (const Hypothesis& h : hypotheses) {
    out.iterations += h.iterations;
    if (h.score > out.rival_score &&
        differ(h.T_target_source, best, fine.T_target_source.inverse() * fine.p_target_centre)) {
      out.rival_score = h.score;
      out.T_target_source_rival = h.T_target_source;
    }
  }
  out.iterations += fine.iterations;
  judge(target, source, fine, threads, out);
  return out;
}

}  // namespace concord
