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
/// What a pair of solid cells counts for, against a pair of planes in the direction that they measure, and what all of
/// them together may: enough to hold what no plane holds, too little to hold back what planes pull.
constexpr double kSolid = 0.05;
constexpr double kSolidShare = 0.01;
constexpr double kTurnPerStep = 0.1;  // radians a metre: metres at a lever arm of ten
constexpr int kRest = 10;             // iterations
constexpr double kRestSteps = 4.0;    // least steps: less than that over so many iterations is no way
constexpr double kMaxStep = 0.5;      // metres an iteration
constexpr double kMaxTurn = 0.15;     // radians an iteration
/// Holds directions that nothing measures in place, relative to the best measured one.
constexpr double kDamping = 1e-6;

struct Sums {
  Matrix6 hessian = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double weight = 0.0;
  double squares = 0.0;
  double flat_weight = 0.0;
  double flat_squares = 0.0;
  std::size_t pairs = 0;

  void add_pair(const Eigen::Vector3d& p, double w, double squared) {
    centre += w * p;
    weight += w;
    squares += w * squared;
    ++pairs;
  }
  void add(const Sums& other) {
    hessian += other.hessian;
    gradient += other.gradient;
    centre += other.centre;
    weight += other.weight;
    squares += other.squares;
    flat_weight += other.flat_weight;
    flat_squares += other.flat_squares;
    pairs += other.pairs;
  }
};

/// Of two flat pieces with normals n and m, each with covariance I - (1 - kFlatness) n n^T: what their sum's inverse,
/// times twice kFlatness, has along the bisector of the normals. All its other eigenvalues are below 2 kFlatness and
/// are left out. 1 for parallel pieces, a half at 3.6 degrees.
struct PlanePair {
  Eigen::Vector3d bisector;
  double information;
};

PlanePair plane_pair(const Eigen::Vector3d& n, const Eigen::Vector3d& m) {
  const double cosine = n.dot(m);
  const double along = 1.0 + std::abs(cosine);  // n n^T + m m^T has it along the bisector
  const Eigen::Vector3d sum = cosine < 0.0 ? Eigen::Vector3d(n - m) : Eigen::Vector3d(n + m);
  return {sum / std::sqrt(2.0 * along), 2.0 * kFlatness / (2.0 - (1.0 - kFlatness) * along)};
}

double solid_weight(std::span<const SurfaceCell> source) {
  double flat = 0.0;
  double solid = 0.0;
  for (const SurfaceCell& cell : source) (cell.is_solid ? solid : flat) += 1.0;
  return solid > 0.0 ? std::min(kSolid, kSolidShare * flat / solid) : kSolid;
}

class Linearisation {
 public:
  Linearisation(const SurfaceLevel& target, std::span<const SurfaceCell> source, const GicpOptions& options)
      : target_(target),
        source_(source),
        options_(options),
        solid_(solid_weight(source)),
        sums_(chunks_of(source.size(), kPointsPerChunk)) {}

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
    Sums out;
    for (const SurfaceCell& point : points) {
      const Eigen::Vector3d p = T * point.mean.cast<double>();
      const SurfaceCell* partner = target_.nearest(p);
      if (partner == nullptr) continue;
      const Eigen::Vector3d d = partner->mean.cast<double>() - p;
      if (partner->is_solid && point.is_solid) {
        add_solid(p, d, pivot, out);
      } else if (partner->is_flat() && point.is_flat()) {
        const Eigen::Vector3d n = partner->normal.cast<double>();
        const Eigen::Vector3d m = T.linear() * point.normal.cast<double>();
        if (!back_to_back(*partner, point, n.dot(m))) add_planes(p, d, plane_pair(n, m), pivot, out);
      }
    }
    return out;
  }

  /// The Geman-McClure kernel's weight of a squared distance.
  [[nodiscard]] double trust(double squared) const {
    const double kernel = options_.kernel * options_.kernel;
    const double ratio = kernel / (kernel + squared);
    return ratio * ratio;
  }

  // p moves by v + omega x arm: along q that is (arm x q) omega + q v.

  void add_planes(const Eigen::Vector3d& p, const Eigen::Vector3d& d, const PlanePair& planes,
                  const Eigen::Vector3d& pivot, Sums& out) const {
    const Eigen::Vector3d& q = planes.bisector;
    const double across = q.dot(d);
    const double squared = planes.information * across * across;
    const double w = trust(squared);
    Vector6 J;
    J << (p - pivot).cross(q), q;
    const Vector6 Jw = w * planes.information * J;
    out.hessian += Jw * J.transpose();
    out.gradient += across * Jw;
    out.add_pair(p, w, squared);
    out.flat_weight += w;
    out.flat_squares += w * across * across;
  }

  void add_solid(const Eigen::Vector3d& p, const Eigen::Vector3d& d, const Eigen::Vector3d& pivot, Sums& out) const {
    const double squared = solid_ * d.squaredNorm();
    const double w = trust(squared);
    const Eigen::Vector3d arm = p - pivot;
    Eigen::Matrix<double, 3, 6> J;
    J << 0, arm.z(), -arm.y(), 1, 0, 0, -arm.z(), 0, arm.x(), 0, 1, 0, arm.y(), -arm.x(), 0, 0, 0, 1;
    out.hessian += w * solid_ * J.transpose() * J;
    out.gradient += w * solid_ * J.transpose() * d;
    out.add_pair(p, w, squared);
  }

  const SurfaceLevel& target_;
  std::span<const SurfaceCell> source_;
  const GicpOptions& options_;
  double solid_;
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

/// Pairs that change from step to step may keep it going round a place for ever: it has come to an end there all the
/// same.
bool is_at_rest(const Transform& before, const Transform& now, const Eigen::Vector3d& p_target, double min_step) {
  const Transform went = now * before.inverse();
  const double turn = Eigen::AngleAxisd(Eigen::Matrix3d(went.linear())).angle();
  return (went * p_target - p_target).norm() < kRestSteps * min_step && turn < kRestSteps * kTurnPerStep * min_step;
}

}  // namespace

GicpResult refine(const SurfaceLevel& target, std::span<const SurfaceCell> source, const Transform& T_target_source,
                  const GicpOptions& options) {
  GicpResult out;
  out.T_target_source = T_target_source;
  Linearisation linearise(target, source, options);
  out.p_target_centre = T_target_source * mean_of(source);
  Transform rested = T_target_source;  // where it was at the last rest
  while (true) {
    const Sums sums = linearise.at(out.T_target_source, out.p_target_centre);
    out.pairs = sums.pairs;
    out.weight = sums.weight;
    out.rms = sums.flat_weight > 0.0 ? std::sqrt(sums.flat_squares / sums.flat_weight) : 0.0;
    out.sigma = sums.weight > 0.0 ? std::sqrt(sums.squares / sums.weight) : 0.0;
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
    out.converged = step.head<3>().norm() < kTurnPerStep * options.min_step && step.tail<3>().norm() < options.min_step;
    if (out.iterations % kRest == 0) {
      out.converged = out.converged || is_at_rest(rested, out.T_target_source, out.p_target_centre, options.min_step);
      rested = out.T_target_source;
    }
    out.p_target_centre = sums.centre / sums.weight;
  }
}

}  // namespace concord
