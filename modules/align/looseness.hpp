#pragma once

#include <string>
#include <vector>

#include "align/align_map.hpp"
#include "core/transform.hpp"

namespace concord {

/// A way in which nothing holds the source.
struct Loose {
  std::string words;     ///< e.g. "slides along x (0.98 0.17 0.00)", in the axes of the target
  Eigen::Vector3d axis;  ///< unit length, the target's axes
  double by = 0.0;       ///< the farthest of those tried that is open: metres, or radians about the axis
  bool turns = false;
};

/// The ways in which nothing holds the source where it lies: moved that way, the maps contradict each other hardly more
/// (is_as_good). Tried along the ground (0.3 to 2 m, where the fewest walls face and across it), in height, and in
/// turns about the vertical through the source's middle (8 and 15 degrees); or far slides along the ground, where all
/// that contradicts is what people may have moved (is_held_by_a_thing). The Hessian alone calls noise of normals a
/// measurement.
[[nodiscard]] std::vector<Loose> loose_directions(const AlignMap& target, const AlignMap& source,
                                                  const Transform& T_target_source, int threads);

}  // namespace concord
