#pragma once

#include <string>
#include <vector>

#include "align/align_map.hpp"
#include "core/transform.hpp"

namespace concord {

/// The ways in which nothing holds the source where it lies: moved that way, the maps contradict each other hardly more
/// (is_as_good). Tried along the ground (0.3 to 2 m, where the fewest walls face and across it), in height, and in
/// turns about the vertical through the source's middle (8 and 15 degrees). E.g. "slides along x (0.98 0.17 0.00)", in
/// the axes of the target. The Hessian alone calls noise of normals a measurement.
[[nodiscard]] std::vector<std::string> loose_directions(const AlignMap& target, const AlignMap& source,
                                                        const Transform& T_target_source, int threads);

}  // namespace concord
