#pragma once

#include <optional>
#include <string>

#include "cli/command.hpp"
#include "core/transform.hpp"

namespace concord {

/// `align` on what the running stack holds.
struct AlignLive {
  std::string source;
  std::string target;                        ///< empty: the map
  std::optional<Transform> T_target_source;  ///< the guess
  bool accept = false;                       ///< if it is found
  std::string picture;                       ///< a PNG; empty: none
  std::string author, id;
};

/// Asks, waits as long as it is worked on, and prints what was found. @return kRefused where that is not sure.
[[nodiscard]] Outcome align_live(const AlignLive& wanted, const Common& common);

/// A person's word on an alignment that was found, or on an offer.
[[nodiscard]] Outcome decide_alignment(const std::string& align_id, bool accept, const std::string& author,
                                       const std::string& id, const Common& common);

/// Prints what can be accepted now, and who has slipped.
[[nodiscard]] Outcome list_alignments(const Common& common);

}  // namespace concord
