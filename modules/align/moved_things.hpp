#pragma once

#include <vector>

#include "align/evidence.hpp"

namespace concord {

/// What stands in one map and not in the other while all around agrees: a shelf that was moved between two sessions.
struct MovedThings {
  std::vector<Eigen::Vector2d> p_target;  ///< middles, at most two: where it stands in either map
  Support rest;                           ///< what the maps say without them
};

/// `found`: support(...) of the same arguments. The two discs that hold the most of what speaks against are taken out.
[[nodiscard]] MovedThings without_moved_things(const AlignMap& target, const AlignMap& source,
                                               const Transform& T_target_source, const Support& found,
                                               std::size_t pieces);

}  // namespace concord
