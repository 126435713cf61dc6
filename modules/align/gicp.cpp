#include "align/gicp.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "align/workers.hpp"

namespace concord {
namespace {

constexpr std::size_t kPointsPerChunk = 512;
/// Variance across a surface over that along it (Segal 2009).
constexpr double kFlatness = 1e-3;
/// What a pair of solid cells counts for, against a pair of planes in the direction that they measure: enough to hold
/// what no plane holds, too little to pull where planes do.
constexpr double kSolid = 0.05;
/// Steps below these end the search: far below what any map can show.
constexpr double kMinStep = 2e-4;  // metres
constexpr double kMinTurn = 2e-5;  // radians
constexpr double kMaxStep = 0.5;   // metres an iteration
constexpr double kMaxTurn = 0.15;  // radians an iteration
/// Holds directions that nothing measures in place, relative to the best measured one.
constexpr double kDamping = 1e-6;

struct Sums {
  Matrix6 hessian = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double weight = 0.0;
  double squares = 0.0;
  std::size_t pairs = 0;

  void add(const Sums& other) {
    hessian += other.hessian;
    gradient += other.gradient;
    centre += other.centre;
    weight += other.weight;
    squares += other.squares;
    pairs += other.pairs;
  }
};

/// Inverse of the summed covariances I - (1 - kFlatness) n n^T of two pieces of surface, times twice kFlatness: the
/// squared length under it is, for parallel pieces, the squared distance across them.
Eigen::Matrix3d information(const Eigen::Vector3d& n, const Eigen::Vector3d& m) {
  const Eigen::Matrix3d sum =
      2.0 * Eigen::Matrix3d::Identity() - (1.0 - kFlatness) * (n * n.transpose() + m * m.transpose());
  return 2.0 * kFlatness * sum.inverse();
}

class Linearisation {
 public:
  Linearisation(const SurfaceLevel& target, std::span<const SurfaceCell> source, const GicpOptions& options)
      : target_(target), source_(source), options_(options), sums_(chunks_of(source.size(), kPointsPerChunk)) {}

  /// Rotations are about `p_target_pivot`.
  Sums at(const Transform& T, const Eigen::Vector3d& p_target_pivot) {
    for_each_chunk(options_.threads, sums_.size(), [&](std::size_t chunk) {
      const std::size_t begin = chunk * kPointsPerChunk;
      const std::size_t end = std::min(source_.size(), begin + kPointsPerChunk);
      sums_[chunk] = sum_of(source_.subspan(begin, end - begin), T, p_target_pivot);
    });
    Sums total;
    for (const Sums& s : sums_) total.add(s);
    return total;
  }

 private:
  Sums sum_of(std::span<const SurfaceCell> points, const Transform& T, const Eigen::Vector3d& pivot) const {
    const double kernel = options_.kernel * options_.kernel;
    Sums out;
    for (const SurfaceCell& point : points) {
      const Eigen::Vector3d p = T * point.mean.cast<double>();
      const SurfaceCell* partner = target_.nearest(p);
      if (partner == nullptr) continue;
      const Eigen::Vector3d d = partner->mean.cast<double>() - p;
      const Eigen::Vector3d n = partner->normal.cast<double>();
      const Eigen::Vector3d m = T.linear() * point.normal.cast<double>();
      if (back_to_back(*partner, point, n.dot(m))) continue;
      const bool both_solid = partner->is_solid && point.is_solid;
      const Eigen::Matrix3d M = both_solid ? Eigen::Matrix3d(kSolid * Eigen::Matrix3d::Identity()) : information(n, m);
      const Eigen::Vector3d Md = M * d;
      const double squared = d.dot(Md);
      const double ratio = kernel / (kernel + squared);
      const double w = ratio * ratio;
      const Eigen::Vector3d arm = p - pivot;
      // p moves by v + omega x arm: J = [-[arm]x, I], so J^T a = (arm x a, a).
      Eigen::Matrix<double, 6, 3> JtM;
      for (int c = 0; c < 3; ++c) {
        JtM.col(c).head<3>() = arm.cross(M.col(c));
        JtM.col(c).tail<3>() = M.col(c);
      }
      JtM *= w;
      Eigen::Matrix<double, 3, 3> cross;
      cross << 0, -arm.z(), arm.y(), arm.z(), 0, -arm.x(), -arm.y(), arm.x(), 0;
      out.hessian.leftCols<3>() -= JtM * cross;
      out.hessian.rightCols<3>() += JtM;
      out.gradient += JtM * d;
      out.centre += w * p;
      out.weight += w;
      out.squares += w * squared;
      ++out.pairs;
    }
    return out;
  }

  const SurfaceLevel& target_;
  std::span<const SurfaceCell> source_;
  const GicpOptions& options_;
  std::vector<Sums> sums_;
};

Transform moved(const Transform& T, const Vector6& step, const Eigen::Vector3d& pivot) {
  const Eigen::Vector3d turn = step.head<3>();
  const double angle = turn.norm();
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  if (angle > 0.0) R = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  Transform out;
  out.linear() = Eigen::Quaterniond(R * T.linear()).normalized().toRotationMatrix();
  out.translation() = R * (T.translation() - pivot) + pivot + step.tail<3>();
  return out;
}

Eigen::Vector3d mean_of(std::span<const SurfaceCell> source) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const SurfaceCell& cell : source) sum += cell.mean.cast<double>();
  return source.empty() ? sum : Eigen::Vector3d(sum / static_cast<double>(source.size()));
}

}  // namespace

GicpResult refine(const SurfaceLevel& target, std::span<const SurfaceCell> source, const Transform& T_target_source,
                  const GicpOptions& options) {
  GicpResult out;
  out.T_target_source = T_target_source;
  Linearisation linearise(target, source, options);
  out.p_target_centre = T_target_source * mean_of(source);
  while (true) {
    const Sums sums = linearise.at(out.T_target_source, out.p_target_centre);
    out.pairs = sums.pairs;
    out.weight = sums.weight;
    out.rms = sums.weight > 0.0 ? std::sqrt(sums.squares / sums.weight) : 0.0;
    out.hessian = sums.hessian;
    if (sums.pairs < 6 || out.converged || out.iterations == options.max_iterations) return out;
    const double damping = kDamping * sums.hessian.diagonal().maxCoeff();
    Vector6 step = (sums.hessian + damping * Matrix6::Identity()).ldlt().solve(sums.gradient);
    if (!step.allFinite()) return out;
    const double scale =
        std::min({1.0, kMaxTurn / (step.head<3>().norm() + 1e-12), kMaxStep / (step.tail<3>().norm() + 1e-12)});
    step *= scale;
    out.T_target_source = moved(out.T_target_source, step, out.p_target_centre);
    ++out.iterations;
    out.converged = step.head<3>().norm() < kMinTurn && step.tail<3>().norm() < kMinStep;
    out.p_target_centre = sums.centre / sums.weight;
  }
}

}  // namespace concord
