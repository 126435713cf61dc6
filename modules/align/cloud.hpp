#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace concord {

/// What make_align_map takes of a cloud that nothing is known of.
struct PreparedCloud {
  std::vector<Eigen::Vector3f> points;
  double resolution = 0.0;  ///< metres, about the distance between points
};

/// Finds out how densely the points lie: the finest of 0.05, 0.1, 0.2 and 0.4 m at which they make a surface. A cloud
/// of over a million points is thinned to the means of cells of half of that. @pre all points are finite and within
/// kMaxSurfaceReach.
[[nodiscard]] PreparedCloud prepare_cloud(std::vector<Eigen::Vector3f> points);

}  // namespace concord
