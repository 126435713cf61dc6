#include "align/align.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "align/gates.hpp"
#include "align/hypotheses.hpp"
#include "align/looseness.hpp"
#include "align/moved_things.hpp"

namespace concord {
namespace {

constexpr std::size_t kJudgePieces = 20'000;
constexpr std::size_t kRivalPieces = 6000;
constexpr int kSettleRounds = 2;
constexpr double kSettleStep = 0.2;                 // metres: twice what the kernel of the finest level heeds
constexpr double kMirrorYaw = 12.0 * M_PI / 180.0;  // twice what the direction of the walls is off by, and a margin
/// What is forgiven: a shelf where it stood and where it stands.
constexpr Movable kShelf{0.75, 2.0};
constexpr std::size_t kPlacesOfAShelf = 2;
constexpr double kMirrorReach = 6.0;  // metres: a part lies as far on the other side of its room

bool has_map(const AlignMap& map) { return map.points.size() >= kMinSurfacePoints; }

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

Support judge(const AlignMap& target, const AlignMap& source, const GicpResult& fine, Origin origin, int threads,
              Alignment& out) {
  out.T_target_source = fine.T_target_source;
  out.p_target_centre = fine.p_target_centre;
  out.rms = fine.rms;
  out.covariance = covariance(fine);
  out.iterations += fine.iterations;
  const Support s = support(target, source, fine.T_target_source, kJudgePieces, threads);
  out.overlap_source = s.overlap_source();
  out.overlap_target = s.overlap_target();
  out.against_upright = s.upright().share_against();
  out.against_level = s.level().share_against();
  const Verdicts all = s.all();
  out.free_space_violation = all.all > 0.0 ? all.contradicted / all.all : 0.0;
  GateAnswer gates = check_gates(s, origin);
  out.reason = gates.reason;
  out.message = std::move(gates.message);
  return s;
}

/// A place that is contradicted only where one thing was moved is believed; `moved` is filled only then.
void forgive_moved_things(const AlignMap& target, const AlignMap& source, const Support& found, MovedThings& moved,
                          Alignment& out) {
  MovedThings things =
      without_moved_things(target, source, out.T_target_source, found, kJudgePieces, kShelf, kPlacesOfAShelf);
  if (!agrees_but_for_moved_things(things.rest)) return;
  moved = std::move(things);
  out.reason = AlignReason::kAccepted;
  out.message.clear();
}

/// What is asked only of a place that passed the gates.
void check_hold(const AlignMap& target, const AlignMap& source, bool converged, int threads, Alignment& out) {
  for (const Loose& direction : loose_directions(target, source, out.T_target_source, threads)) {
    out.loose.push_back(direction.words);
    const int block = direction.turns ? 0 : 3;
    out.covariance.block<3, 3>(block, block) +=
        direction.by * direction.by * direction.axis * direction.axis.transpose();  // what noise told does not hold
  }
  if (!out.loose.empty()) {
    std::string loose;
    for (const std::string& direction : out.loose) loose += (loose.empty() ? "" : ", ") + direction;
    out.reason = AlignReason::kDegenerate;
    out.message = "what both have seen leaves it open: " + loose + "; map something that holds it";
  } else if (!converged) {
    out.reason = AlignReason::kDiverged;
    out.message = "refinement came to no end; give a better guess";
  }
}

/// Other places that explain the two as well. What refines to the answer is none: it was on its way there.
void find_rivals(const AlignMap& target, const AlignMap& source, const std::vector<Hypothesis>& hypotheses,
                 const Support& accepted, Origin origin, int threads, Alignment& out) {
  const Eigen::Vector3d p_source = middle_of(source);
  for (const Hypothesis& h : hypotheses) {
    if (!are_apart(h.T_target_source, out.T_target_source, p_source) || !may_rival(h.support)) continue;
    const GicpResult rival = refine_fully(target, source, h.T_target_source, threads);
    out.iterations += rival.iterations;
    const auto is_same = [&](const Transform& T) { return !are_apart(rival.T_target_source, T, p_source); };
    if (is_same(out.T_target_source)) continue;
    if (!is_rival(support(target, source, rival.T_target_source, kRivalPieces, threads), accepted, origin)) continue;
    auto& rivals = out.T_target_source_rivals;
    if (std::none_of(rivals.begin(), rivals.end(), is_same)) rivals.push_back(rival.T_target_source);
  }
  if (out.T_target_source_rivals.empty()) return;
  out.reason = AlignReason::kAmbiguous;
  out.message =
      std::to_string(out.T_target_source_rivals.size() + 1) +
      " places explain the maps; map what sets them apart, or guess nearer to the right one than to the others";
}

/// The source's mirror image, put where its walls face as the source's do where it lies: mirrored in an upright plane
/// through its middle along its walls, or across them, and for square rooms turned by a quarter.
std::vector<Transform> mirrored_on_the_spot(const AlignMap& source, const Transform& T_target_source,
                                            const Eigen::Vector2d& facing) {
  const Eigen::Vector3d n(facing.x(), facing.y(), 0.0);
  const Eigen::Matrix3d in_target = Eigen::Matrix3d::Identity() - 2.0 * n * n.transpose();
  const Eigen::Matrix3d in_source = Eigen::Vector3d(-1.0, 1.0, 1.0).asDiagonal();
  const Eigen::Vector3d p_target = T_target_source * middle_of(source);
  std::vector<Transform> out;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const Eigen::AngleAxisd turn(0.5 * M_PI * quarter, Eigen::Vector3d::UnitZ());
    Transform T = Transform::Identity();
    T.linear() = turn.toRotationMatrix() * in_target * T_target_source.linear() * in_source;
    T.translation() = p_target - T.linear() * in_source * middle_of(source);
    out.push_back(T);
  }
  return out;
}

/// A room of the same plan, or a map with its left and right exchanged, lies on the walls as well; but something is
/// against it, and its mirror image lies better.
void try_mirrored(const AlignMap& target, const AlignMap& source, const Support& accepted, const MovedThings& moved,
                  int threads, Alignment& out) {
  if (!may_be_mirrored(accepted)) return;
  const AlignMap image = mirrored(source, threads);
  const auto lies_better = [&](const Transform& T) {
    const Support mirrored_support = support(target, image, T, kJudgePieces, threads);
    if (is_better_mirrored(mirrored_support, accepted)) return true;
    return !moved.p_target.empty() &&
           is_as_good_mirrored(
               without_moved_things(target, image, T, mirrored_support, kJudgePieces, kShelf, kPlacesOfAShelf).rest,
               moved.rest);
  };
  for (const Transform& T : mirrored_on_the_spot(source, out.T_target_source, accepted.weak_direction())) {
    const auto hypotheses = find_hypotheses(target, image, Vicinity{T, kMirrorYaw, kMirrorReach}, threads);
    if (hypotheses.empty() || !may_rival(hypotheses.front().support)) continue;
    const GicpResult fine = refine_fully(target, image, hypotheses.front().T_target_source, threads);
    out.iterations += fine.iterations;
    if (!lies_better(fine.T_target_source)) continue;
    out.reason = AlignReason::kDiverged;
    out.message =
        "the source's mirror image lies better in the target than the source does: is it another room of the "
        "same plan, or a map with left and right exchanged?";
    return;
  }
}

Alignment no_map(const AlignMap& target, const AlignMap& source) {
  Alignment out;
  const bool is_source = !has_map(source);
  out.message = std::string("the ") + (is_source ? "source" : "target") + " has " +
                std::to_string((is_source ? source : target).points.size()) + " points of surface, " +
                std::to_string(kMinSurfacePoints) + " asked; let it explore first";
  return out;
}

Alignment worded(Alignment out, const MovedThings& moved) {
  if (!out.accepted()) return out;
  char text[64];
  std::snprintf(text, sizeof text, "aligned: %.0f %% overlap, %.0f mm rms", 100.0 * out.overlap(), 1000.0 * out.rms);
  out.message = text;
  for (const Eigen::Vector2d& p : moved.p_target) {
    std::snprintf(text, sizeof text, "%s (%.1f %.1f)", &p == moved.p_target.data() ? "; moved between the two:" : "",
                  p.x(), p.y());
    out.message += text;
  }
  return out;
}

}  // namespace

Alignment align(const AlignMap& target, const AlignMap& source, const std::optional<Transform>& guess, int threads) {
  Alignment out;
  if (!has_map(target) || !has_map(source)) return no_map(target, source);
  std::optional<Vicinity> vicinity;
  if (guess) vicinity = around_guess(*guess);
  const std::vector<Hypothesis> hypotheses = find_hypotheses(target, source, vicinity, threads);
  out.hypotheses = static_cast<int>(hypotheses.size());
  for (const Hypothesis& h : hypotheses) out.iterations += h.iterations;
  if (hypotheses.empty()) {
    out.reason = AlignReason::kLowOverlap;
    out.message = guess ? "the two share no place near the guess" : "no place was found where one lies on the other";
    return out;
  }
  const Origin origin = guess ? Origin::kGuess : Origin::kAnywhere;
  GicpResult fine = refine_fully(target, source, hypotheses.front().T_target_source, threads);
  Support found = judge(target, source, fine, origin, threads, out);
  if (out.reason == AlignReason::kDiverged) {
    out.iterations -= fine.iterations;
    fine = settle(target, source, fine, threads);
    found = judge(target, source, fine, origin, threads, out);
  }
  // Without a guess nothing but what stands in the room tells the place, so nothing is taken out.
  MovedThings moved{{}, found};
  if (guess && out.reason == AlignReason::kDiverged) forgive_moved_things(target, source, found, moved, out);
  if (out.accepted()) check_hold(target, source, fine.converged, threads, out);
  if (out.accepted() && vicinity && !is_in(*vicinity, out.T_target_source, middle_of(source))) {
    out.reason = AlignReason::kLowOverlap;
    out.message = "what was found lies farther from the guess than 2 m and 45 degrees; give a better guess, or none";
  }
  if (out.accepted()) find_rivals(target, source, hypotheses, found, origin, threads, out);
  if (out.accepted()) try_mirrored(target, source, found, moved, threads, out);
  return worded(std::move(out), moved);
}

Alignment recheck(const AlignMap& target, const AlignMap& source, const Transform& T_target_source, int threads) {
  Alignment out;
  if (!has_map(target) || !has_map(source)) return no_map(target, source);
  out.hypotheses = 1;
  const GicpResult fine = refine_finely(target, source, T_target_source, threads);
  judge(target, source, fine, Origin::kGuess, threads, out);
  if (out.accepted()) check_hold(target, source, fine.converged, threads, out);
  return worded(std::move(out), {});
}

}  // namespace concord
