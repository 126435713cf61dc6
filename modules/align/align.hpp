#pragma once

#include <optional>
#include <string>
#include <vector>

#include "align/align_map.hpp"
#include "align/evidence.hpp"
#include "core/transform.hpp"

namespace concord {

enum class AlignReason {
  kAccepted,
  kNoMap,       ///< too little surface in one of the two
  kLowOverlap,  ///< too little of either lies on the other
  kDiverged,    ///< refinement went away, or the two contradict each other where it ended
  kDegenerate,  ///< the surfaces leave a direction open
  kAmbiguous,   ///< another place explains the two almost as well
};
/// As it travels, e.g. "LOW_OVERLAP".
[[nodiscard]] const char* name(AlignReason reason);

/// An answer with all that speaks for it and against it.
struct Alignment {
  AlignReason reason = AlignReason::kNoMap;
  Transform T_target_source = Transform::Identity();  ///< the best that was found, accepted or not
  double overlap_source = 0.0;                        ///< share of the source's flat surface that lies on the target's
  double overlap_target = 0.0;
  double rms = 0.0;                      ///< metres across the surface, of the pairs that the kernel trusts
  Matrix6 covariance = Matrix6::Zero();  ///< see covariance()
  std::vector<std::string> loose;        ///< directions that the surfaces leave open, in words
  double contradiction_upright = 0.0;    ///< of the walls seen by both: the share that stands where the other saw none
  double contradiction_level = 0.0;      ///< the same of floors and ceilings
  double score = 0.0;                    ///< square metres that speak for it
  double rival_score = 0.0;              ///< of the best other place
  Transform T_target_source_rival = Transform::Identity();
  int iterations = 0;
  int hypotheses = 0;  ///< places that were refined and judged
  std::string words;   ///< one line for people: why, and what to do

  [[nodiscard]] bool accepted() const { return reason == AlignReason::kAccepted; }
  /// Of the two maps, the one that is covered better.
  [[nodiscard]] double overlap() const { return std::max(overlap_source, overlap_target); }
};

/// Where the source lies in the target: from a person's rough guess (within 2 m, 45 degrees of yaw), or from none.
/// Both maps are z up to within a few degrees. A pure function; the number of threads does not change a bit of it.
/// @pre `guess` is a rigid transform with finite components (see make_transform).
[[nodiscard]] Alignment align(const AlignMap& target, const AlignMap& source, const std::optional<Transform>& guess,
                              int threads);

/// Refines a transform that is right to within a voxel or two, and judges it: the watch over an aligned agent.
[[nodiscard]] Alignment recheck(const AlignMap& target, const AlignMap& source, const Transform& T_target_source,
                                int threads);

}  // namespace concord
