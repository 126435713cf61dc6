#include "align/align.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "align/gates.hpp"
#include "align/hypotheses.hpp"

namespace concord {
namespace {

constexpr std::size_t kJudgePieces = 20'000;
constexpr std::size_t kRivalPieces = 6000;
constexpr int kSettleRounds = 2;
constexpr double kSettleStep = 0.2;  // metres: twice what the kernel of the finest level heeds
/// Metres; the least is what would do harm.
constexpr std::array<double, 8> kSlides{-0.3, 0.3, -0.6, 0.6, -1.0, 1.0, -2.0, 2.0};

bool has_map(const AlignMap& map) { return map.points.size() >= kMinSurfacePoints; }

/// Slides the source along the ground from where it was found: a place that is as good says that nothing holds it.
void probe_slides(const AlignMap& target, const AlignMap& source, int threads, Alignment& out) {
  const auto at = [&](const Transform& T) { return support(target, source, T, kRivalPieces, threads); };
  const Support good = at(out.T_target_source);
  const Eigen::Vector2d weak = good.weak_direction();
  for (const Eigen::Vector2d& axis : {weak, Eigen::Vector2d(-weak.y(), weak.x())}) {
    for (const double step : kSlides) {
      Transform T = out.T_target_source;
      T.translation().head<2>() += step * axis;
      if (!is_as_good(at(T), good)) continue;
      out.loose.push_back(name_slide({axis.x(), axis.y(), 0.0}));
      break;
    }
  }
}

/// Refinement may end beside the place: a wall that lies off by more than the kernel heeds pulls no longer. So where
/// something speaks against a place its surroundings are tried, and what is better is gone on from.
GicpResult settle(const AlignMap& target, const AlignMap& source, GicpResult fine, int threads) {
  const auto at = [&](const GicpResult& result) {
    return support(target, source, result.T_target_source, kRivalPieces, threads);
  };
  Support best = at(fine);
  for (int round = 0; round < kSettleRounds; ++round) {
    const Eigen::Vector2d weak = best.weak_direction();
    const Eigen::Vector3d axes[] = {{weak.x(), weak.y(), 0.0}, {-weak.y(), weak.x(), 0.0}, Eigen::Vector3d::UnitZ()};
    const GicpResult from = fine;
    bool is_better = false;
    for (const Eigen::Vector3d& axis : axes) {
      for (const double step : {-kSettleStep, kSettleStep}) {
        Transform T = from.T_target_source;
        T.translation() += step * axis;
        GicpResult tried = refine_finely(target, source, T, threads);
        fine.iterations += tried.iterations;
        const Support support = at(tried);
        if (!ranks_before(support, best)) continue;
        tried.iterations = fine.iterations;
        fine = tried;
        best = support;
        is_better = true;
      }
    }
    if (!is_better) break;
  }
  return fine;
}

void judge(const AlignMap& target, const AlignMap& source, const GicpResult& fine, Origin origin, int threads,
           Alignment& out) {
  out.T_target_source = fine.T_target_source;
  out.rms = fine.rms;
  out.covariance = covariance(fine);
  out.iterations += fine.iterations;
  const Support s = support(target, source, fine.T_target_source, kJudgePieces, threads);
  out.overlap_source = s.overlap_source();
  out.overlap_target = s.overlap_target();
  out.against_upright = s.upright().share_against();
  out.against_level = s.level().share_against();
  const double all = s.upright().all + s.level().all;
  out.free_space_violation = all > 0.0 ? (s.upright().contradicted + s.level().contradicted) / all : 0.0;
  out.reason = check_gates(s, origin);
  if (out.reason == AlignReason::kDegenerate) out.loose.push_back(name_slide(Eigen::Vector3d::UnitZ()));
  if (!out.accepted()) return;
  probe_slides(target, source, threads, out);
  if (!out.loose.empty()) {
    out.reason = AlignReason::kDegenerate;
  } else if (!fine.converged) {
    out.reason = AlignReason::kDiverged;
  }
}

/// Another place that explains the two as well. What refines to the answer is none: it was on its way there.
void find_rival(const AlignMap& target, const AlignMap& source, const std::vector<Hypothesis>& hypotheses, int threads,
                Alignment& out) {
  const Eigen::Vector3d p_source = middle_of(source);
  for (const Hypothesis& h : hypotheses) {
    if (!are_apart(h.T_target_source, out.T_target_source, p_source) || !is_plausible(h.support)) continue;
    const GicpResult rival = refine_fully(target, source, h.T_target_source, threads);
    out.iterations += rival.iterations;
    if (!are_apart(rival.T_target_source, out.T_target_source, p_source)) continue;
    out.reason = AlignReason::kAmbiguous;
    return;
  }
}

std::string words(const Alignment& a) {
  const auto percent = [](double share) { return std::to_string(std::lround(100.0 * share)) + " %"; };
  std::string loose;
  for (const std::string& direction : a.loose) loose += (loose.empty() ? "" : ", ") + direction;
  switch (a.reason) {
    case AlignReason::kAccepted:
      return "aligned: " + percent(a.overlap()) + " overlap, " + std::to_string(std::lround(1000.0 * a.rms)) +
             " mm rms";
    case AlignReason::kNoMap: return "there is no map to align yet; let both explore first";
    case AlignReason::kLowOverlap:
      return "only " + percent(a.overlap()) + " of either map lies on the other; map more of what both have seen" +
             std::string(", or give a guess");
    case AlignReason::kDiverged:
      return "the maps contradict each other there (" + percent(a.against_upright) + " of the walls, " +
             percent(a.against_level) + " of the floors and ceilings); give a better guess, or map the place anew";
    case AlignReason::kDegenerate:
      return "the walls that both have seen leave it open: " + loose + "; map something that faces that way";
    case AlignReason::kAmbiguous:
      return "another place explains the maps as well; give a guess, or map more of what sets the places apart";
  }
  return {};
}

Alignment worded(Alignment alignment) {
  alignment.message = words(alignment);
  return alignment;
}

Alignment find(const AlignMap& target, const AlignMap& source, const std::optional<Transform>& guess, int threads) {
  Alignment out;
  if (!has_map(target) || !has_map(source)) return out;
  const std::vector<Hypothesis> hypotheses = find_hypotheses(target, source, guess, threads);
  out.hypotheses = static_cast<int>(hypotheses.size());
  for (const Hypothesis& h : hypotheses) out.iterations += h.iterations;
  if (hypotheses.empty()) {
    out.reason = AlignReason::kLowOverlap;
    return out;
  }
  const Origin origin = guess ? Origin::kGuess : Origin::kAnywhere;
  const GicpResult fine = refine_fully(target, source, hypotheses.front().T_target_source, threads);
  judge(target, source, fine, origin, threads, out);
  if (out.reason == AlignReason::kDiverged) {
    out.iterations -= fine.iterations;
    judge(target, source, settle(target, source, fine, threads), origin, threads, out);
  }
  if (!out.accepted()) return out;
  find_rival(target, source, hypotheses, threads, out);
  return out;
}

}  // namespace

Alignment align(const AlignMap& target, const AlignMap& source, const std::optional<Transform>& guess, int threads) {
  return worded(find(target, source, guess, threads));
}

Alignment recheck(const AlignMap& target, const AlignMap& source, const Transform& T_target_source, int threads) {
  Alignment out;
  if (!has_map(target) || !has_map(source)) return worded(out);
  out.hypotheses = 1;
  judge(target, source, refine_finely(target, source, T_target_source, threads), Origin::kGuess, threads, out);
  return worded(out);
}

}  // namespace concord
