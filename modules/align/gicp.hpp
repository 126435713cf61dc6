#pragma once

#include <span>
#include <vector>

#include "align/surface_level.hpp"
#include "core/transform.hpp"

namespace concord {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

struct GicpResult {
  Transform T_target_source = Transform::Identity();
  int iterations = 0;
  bool converged = false;
  std::size_t pairs = 0;  ///< points of the source that had a partner at the end
  double rms = 0.0;       ///< metres, across the surfaces, of the flat pairs as far as the kernel trusts them
  double sigma = 0.0;     ///< metres: the error of a pair that counts whole, turned normals and solid pairs among them
  double weight = 0.0;    ///< sum of the kernel's weights over all pairs
  /// Gauss-Newton Hessian per square metre of error across the surface: rotation about `p_target_centre`, then
  /// translation, in the target's axes.
  Matrix6 hessian = Matrix6::Zero();
  Eigen::Vector3d p_target_centre = Eigen::Vector3d::Zero();  ///< mean of the pairs
};

struct GicpOptions {
  double kernel = 0.1;  ///< metres across the surface at which a pair's weight has fallen to a quarter
  int max_iterations = 20;
  /// Metres; a smaller step, and a turn by a tenth of it a metre, ends the search; so does less than four of them over
  /// ten iterations, round a place where pairs change from step to step.
  double min_step = 2e-4;
  int threads = 1;
};

/// Generalised ICP (Segal, Haehnel and Thrun, RSS 2009) of points with normals against the cells of a surface, each
/// paired with the nearest mean (Koide et al., ICRA 2021), under the Geman-McClure kernel, by Gauss-Newton on SE(3).
/// Sums are taken in fixed partitions: any number of threads gives the same bits.
[[nodiscard]] GicpResult refine(const SurfaceLevel& target, std::span<const SurfaceCell> source,
                                const Transform& T_target_source, const GicpOptions& options);

}  // namespace concord
