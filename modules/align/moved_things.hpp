#pragma once

#include <vector>

#include "align/evidence.hpp"

namespace concord {

/// What people move: no wider and no higher than this, metres. What is higher is part of the building.
struct Movable {
  double radius = 0.0;
  double height = 0.0;
};

/// What stands in one map and not in the other while all around agrees: a shelf that was moved between two sessions.
struct MovedThings {
  std::vector<Eigen::Vector2d> p_target;  ///< middles of the discs, at most `most`
  Support rest;                           ///< what the maps say without them
};

/// `found`: support(...) of the same arguments. Of what speaks against, what the discs that hold the most of it hold is
/// taken out, one after the other, until one is higher than what people move.
[[nodiscard]] MovedThings without_moved_things(const AlignMap& target, const AlignMap& source,
                                               const Transform& T_target_source, const Support& found,
                                               std::size_t pieces, const Movable& movable, std::size_t most);

}  // namespace concord
