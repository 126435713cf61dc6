#pragma once

#include <optional>
#include <vector>

#include "align/align_map.hpp"
#include "core/transform.hpp"

namespace concord {

/// A place for the source in the plane, between upright frames.
struct PlanarPose {
  double yaw = 0.0;                             ///< radians
  Eigen::Vector2d t = Eigen::Vector2d::Zero();  ///< metres: p_target = R(yaw) p_source + t
  double score = 0.0;                           ///< 1: all walls of the source stand on walls of the target
};

/// Where to look. Without a guess everywhere that the two could touch.
struct SearchWindow {
  std::optional<Transform> guess;  ///< T_target_source between upright frames
  double yaw = 0.0;                ///< radians to either side of the guess
  double reach = 0.0;              ///< metres to either side
};

/// The best places in the plane, best first, no two within five cells of the search (0.5 m in a room, 1 m in a
/// building) and ten degrees of each other.
///
/// Branch and bound over yaw, x and y (Olson, ICRA 2009; Hess et al., ICRA 2016): the score of a place is the mean,
/// over the source's wall columns, of what the target's picture shows there, and the largest value of a window bounds
/// it for all places in it. Nodes are opened best first, in batches of fixed size, so that the places come out in order
/// and do not depend on the number of threads. A guess' window is the union over several points of the source that
/// people may have turned it about.
///
/// Where there is too much to look at (over 4 million windows, as for a source of 200 m without a guess) what stands
/// far off is left out, and if that is of no help there are no places.
/// @throws Stopped: see StopScope.
[[nodiscard]] std::vector<PlanarPose> search_columns(const AlignMap& target, const Eigen::Matrix3d& R_upright_target,
                                                     const AlignMap& source, const Eigen::Matrix3d& R_upright_source,
                                                     const SearchWindow& window, int threads);

}  // namespace concord
