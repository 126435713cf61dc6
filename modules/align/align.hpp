#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "align/align_map.hpp"
#include "align/gates.hpp"
#include "align/gicp.hpp"
#include "core/transform.hpp"

namespace concord {

/// An answer with all that speaks for it and against it.
struct Alignment {
  AlignReason reason = AlignReason::kNoMap;
  Transform T_target_source = Transform::Identity();  ///< the best that was found, accepted or not
  double overlap_source = 0.0;                        ///< share of the source's flat surface that lies on the target's
  double overlap_target = 0.0;
  double rms = 0.0;                      ///< metres across the surface, of the pairs that the kernel trusts
  Matrix6 covariance = Matrix6::Zero();  ///< see covariance(), about the middle of the pairs
  std::vector<std::string> loose;        ///< directions that the surfaces leave open, e.g. "slides along x (...)"
  double against_upright = 0.0;          ///< of the walls that the other map can speak of: the share it speaks against
  double against_level = 0.0;            ///< the same of floors and ceilings
  double free_space_violation = 0.0;     ///< share of the surface, both ways, in what the other saw to be free
  double score = 0.0;                    ///< square metres, see Support::score
  std::optional<Transform> T_target_source_rival;  ///< another place that explains the two as well
  int iterations = 0;
  int hypotheses = 0;  ///< places that were refined and judged

  [[nodiscard]] bool accepted() const { return reason == AlignReason::kAccepted; }
  /// Of the map that is covered better.
  [[nodiscard]] double overlap() const { return std::max(overlap_source, overlap_target); }
};

/// Where the source lies in the target: from a person's rough guess (within 2 m, 45 degrees of yaw), or from none.
/// Both maps are z up to within a few degrees; a guess may say that the source's frame is not.
/// A pure function; the number of threads does not change a bit of it.
/// @pre `guess` is a rigid transform with finite components (see make_transform).
[[nodiscard]] Alignment align(const AlignMap& target, const AlignMap& source, const std::optional<Transform>& guess,
                              int threads);

/// Refines a transform that is right to within some voxels, and judges it: the watch over an aligned agent.
[[nodiscard]] Alignment recheck(const AlignMap& target, const AlignMap& source, const Transform& T_target_source,
                                int threads);

/// One line for people: what was found, or why it was refused and what to do about it.
[[nodiscard]] std::string words(const Alignment& alignment);

}  // namespace concord
