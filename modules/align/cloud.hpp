#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace concord {

/// At which a map or a cloud of any other is aligned, metres, finest first.
inline constexpr double kAlignResolutions[] = {0.05, 0.1, 0.2, 0.4};

/// What make_align_map takes of a cloud that nothing is known of.
struct PreparedCloud {
  std::vector<Eigen::Vector3f> points;
  double resolution = 0.0;  ///< metres, about the distance between points
};

/// Finds out how densely the points lie: the finest of kAlignResolutions at which they make a surface. A cloud of over
/// a million points is thinned for it. @pre all points are finite and within
/// kMaxSurfaceReach.
[[nodiscard]] PreparedCloud prepare_cloud(std::vector<Eigen::Vector3f> points);

/// The means of the points in each cell of half a `resolution`; those that are too scattered for that (see
/// are_scattered) stay as they are. @pre as above.
[[nodiscard]] std::vector<Eigen::Vector3f> thinned(std::vector<Eigen::Vector3f> points, double resolution);

}  // namespace concord
