#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
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

/// What speaks for an alignment and against it.
struct AlignEvidence {
  std::string reason;   ///< ACCEPTED, NO_MAP, LOW_OVERLAP, DIVERGED, DEGENERATE or AMBIGUOUS
  std::string message;  ///< for a person
  Transform T_target_source = Transform::Identity();  ///< the best that was found, accepted or not
  double overlap_source = 0.0;                        ///< share of the source's flat surface that lies on the target's
  double overlap_target = 0.0;
  double rms = 0.0;                     ///< metres across the surface
  std::array<double, 36> covariance{};  ///< of turn (rad) and shift (m) in the target's frame, row by row
  std::vector<std::string> loose;       ///< directions that the surfaces leave open
  double against_upright = 0.0;         ///< of the walls that the other map can speak of: the share it speaks against
  double against_level = 0.0;           ///< the same of floors and ceilings
  double free_space_violation = 0.0;    ///< share of the surface in what the other saw to be free
  std::int32_t iterations = 0;
  std::int32_t hypotheses = 0;  ///< places that were refined and judged
  double ms = 0.0;              ///< milliseconds it took

  [[nodiscard]] bool accepted() const { return reason == "ACCEPTED"; }
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
  AlignEvidence evidence;
  bool open = false;        ///< it can be accepted
  double slip = 0.0;        ///< of an offer: metres by which the agent would be moved, at its middle
  double slip_angle = 0.0;  ///< radians
  std::int64_t utime = 0;   ///< when it was found, microseconds since 1970
};

}  // namespace concord
