#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/requests.hpp"
#include "core/transform.hpp"

namespace concord {

/// What people ask of alignment, and what it answers: values that the bus has already checked, as in core/requests.hpp.

/// Where one agent's submap lies in another's, or in the map: the other agents' submaps as they lie now.
struct AlignRequest {
  std::string id;
  std::string author;
  std::string source;                        ///< the agent that is to be placed
  std::string source_frame_id;               ///< empty: its present one
  std::string target;                        ///< an agent; empty: the map
  std::string target_frame_id;               ///< empty: its present one; not heeded for the map
  std::optional<Transform> T_target_source;  ///< a rough guess: within 2 m and 45 degrees of yaw
  std::int64_t utime = 0;                    ///< when it was asked, microseconds since 1970
};

/// A person's word on a request: what it found is put into the map, or it is over.
struct AlignDecision {
  enum class Op {
    kAccept,
    kDrop,  ///< one that waits or runs is cancelled, an answer is withdrawn
  };
  std::string id;
  std::string author;
  Op op = Op::kAccept;
  std::string align_id;  ///< of the AlignRequest, or of an offer
  std::int64_t utime = 0;
};

enum class AlignReason {
  kAccepted,
  kNoMap,       ///< too little surface in one of the two
  kLowOverlap,  ///< too little of either lies on the other
  kDiverged,    ///< refinement came to no end, or the two contradict each other there
  kDegenerate,  ///< the surfaces leave a direction open
  kAmbiguous,   ///< another place explains the two as well
};
/// As it travels, e.g. "LOW_OVERLAP".
[[nodiscard]] const char* name(AlignReason reason);
[[nodiscard]] std::optional<AlignReason> align_reason(std::string_view name);

/// Where a source was found in a target, with all that speaks for it and against it.
struct Alignment {
  AlignReason reason = AlignReason::kNoMap;
  std::string message;                                ///< for a person: what was found, or why not and what to do
  Transform T_target_source = Transform::Identity();  ///< the best that was found, accepted or not
  double overlap_source = 0.0;                        ///< share of the source's flat surface that lies on the target's
  double overlap_target = 0.0;
  double rms = 0.0;  ///< metres across the flat surface, of the pairs as far as the kernel trusts them
  /// Of a small turn (rad) about `p_target_centre` and a shift (m), in the target's axes.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Vector3d p_target_centre = Eigen::Vector3d::Zero();  ///< about the middle of the pairs
  /// Where AMBIGUOUS: the other places that explain the maps as well. Each is found by a guess near it.
  std::vector<Transform> T_target_source_rivals;
  std::vector<std::string> loose;     ///< directions that the surfaces leave open, e.g. "slides along x (...)"
  double against_upright = 0.0;       ///< of the walls that the other map can speak of: the share it speaks against
  double against_level = 0.0;         ///< the same of floors and ceilings
  double free_space_violation = 0.0;  ///< share of the surface, both ways, in what the other saw to be free
  std::int32_t iterations = 0;
  std::int32_t hypotheses = 0;  ///< places that were refined and judged
  double ms = 0.0;              ///< milliseconds it took, as who asked for it measured

  [[nodiscard]] bool accepted() const { return reason == AlignReason::kAccepted; }
  /// Of the map that is covered better.
  [[nodiscard]] double overlap() const { return std::max(overlap_source, overlap_target); }
};

/// The answer to an AlignRequest, or what the watch over aligned agents offers.
struct AlignResult {
  /// A layer that was used, and up to which of its revisions.
  struct Used {
    std::string agent;
    std::string frame_id;
    std::int64_t revision = 0;
  };
  std::string id;      ///< the request's; of an offer its own
  std::string author;  ///< who asked; empty: an offer
  std::string target;  ///< empty: the map
  Used source;
  std::vector<Used> layers;  ///< that made up the target, by id
  Alignment evidence;
  bool open = false;        ///< it can be accepted
  double slip = 0.0;        ///< of an offer: metres by which the agent would be moved, at its middle
  double slip_angle = 0.0;  ///< radians
  std::int64_t utime = 0;   ///< when it was found, microseconds since 1970
};

}  // namespace concord
