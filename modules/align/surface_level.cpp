#include "align/surface_level.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "align/workers.hpp"

namespace concord {
namespace {

constexpr std::size_t kCellsPerChunk = 1024;
/// Fewer points than this make any plane.
constexpr double kMinPlanePoints = 6.0;
/// A plane is thin: its smallest variance is below this share of the middle one. Voxel centres on a slanted wall reach
/// 0.06, an edge of two walls has 0.3 and more.
constexpr double kMaxThickness = 0.15;
/// What is no plane is solid when its cell has as many points as this share of the median flat one, and as many of the
/// 27 cells around are taken: noise spread over a room reaches neither.
constexpr double kMinSolidShare = 0.25;
constexpr double kMinSolidPoints = 2.0;
constexpr int kMinSolidNeighbours = 6;
constexpr double kStray = 2.0;  // standard deviations across
/// Where to look for free space on either side, in cells.
constexpr double kNearSide = 2.0;
constexpr double kFarSide = 3.5;

struct Plane {
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  double thickness = 0.0;  // metres, standard deviation across
};

Plane plane_of(const Moments& m) {
  if (m.count < kMinPlanePoints) return {};
  const Eigen::Vector3d mean = m.sum / m.count;
  Eigen::Matrix3d covariance;
  const auto& o = m.outer;
  covariance << o[0], o[1], o[2], o[1], o[3], o[4], o[2], o[4], o[5];
  covariance = covariance / m.count - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3d variances = solver.eigenvalues();
  if (!(variances[1] > 0.0) || variances[0] > kMaxThickness * variances[1]) return {};
  return {solver.eigenvectors().col(0).normalized().cast<float>(), std::sqrt(std::max(variances[0], 0.0))};
}

}  // namespace

void Moments::add(const Eigen::Vector3d& p) {
  count += 1.0;
  sum += p;
  outer[0] += p.x() * p.x();
  outer[1] += p.x() * p.y();
  outer[2] += p.x() * p.z();
  outer[3] += p.y() * p.y();
  outer[4] += p.y() * p.z();
  outer[5] += p.z() * p.z();
}

void Moments::add(const Moments& other) {
  count += other.count;
  sum += other.sum;
  outer += other.outer;
}

SurfaceLevel::SurfaceLevel(std::span<const Eigen::Vector3f> points, double size, int threads)
    : size_(size), per_metre_(1.0 / size) {
  StopLook stop;
  for (const Eigen::Vector3f& point : points) {
    stop.step();
    const Eigen::Vector3d p = point.cast<double>();
    const auto cell = static_cast<std::size_t>(table_.insert(cell_of(p, per_metre_)));
    if (cell == moments_.size()) moments_.emplace_back();
    moments_[cell].add(p);
  }
  find_planes(threads);
}

SurfaceLevel::SurfaceLevel(const SurfaceLevel& finer, double size, int threads) : size_(size), per_metre_(1.0 / size) {
  StopLook stop;
  for (const Moments& moments : finer.moments_) {
    stop.step();
    const auto cell = static_cast<std::size_t>(table_.insert(cell_of(moments.sum / moments.count, per_metre_)));
    if (cell == moments_.size()) moments_.emplace_back();
    moments_[cell].add(moments);
  }
  find_planes(threads);
}

/// Of the points in the 27 cells around; `neighbours`: how many of them are taken.
Moments SurfaceLevel::around(VoxelIndex cell, int& neighbours) const {
  Moments out;
  neighbours = 0;
  CellTable::Cursor cursor(table_);
  for (int step = 0; step < 27; ++step) {
    const int found = cursor.find({cell.x + step % 3 - 1, cell.y + step / 3 % 3 - 1, cell.z + step / 9 - 1});
    if (found < 0) continue;
    out.add(moments_[found]);
    ++neighbours;
  }
  return out;
}

SurfacePoints SurfaceLevel::without_strays(const SurfacePoints& points, int threads) const {
  std::vector<Eigen::Vector3d> means(cells_.size());
  for_each_chunk(threads, chunks_of(cells_.size(), kCellsPerChunk), [&](std::size_t chunk) {
    const std::size_t end = std::min(cells_.size(), (chunk + 1) * kCellsPerChunk);
    for (std::size_t i = chunk * kCellsPerChunk; i < end; ++i) {
      int neighbours = 0;
      const Moments moments = around(table_.cells()[i], neighbours);
      means[i] = moments.sum / moments.count;
    }
  });
  SurfacePoints out;
  CellTable::Cursor cursor(table_);
  StopLook stop;
  for (const Eigen::Vector3f& point : points) {
    stop.step();
    const Eigen::Vector3d p = point.cast<double>();
    const int cell = cursor.find(cell_of(p, per_metre_));
    const Eigen::Vector3d n = cells_[cell].normal.cast<double>();
    if (std::abs(n.dot(p - means[cell])) <= kStray * thickness_) out.push_back(point);
  }
  return out;
}

void SurfaceLevel::find_planes(int threads) {
  cells_.resize(moments_.size());
  std::vector<char> crowded(moments_.size());
  std::vector<double> thickness(moments_.size());
  for_each_chunk(threads, chunks_of(cells_.size(), kCellsPerChunk), [&](std::size_t chunk) {
    const std::size_t end = std::min(cells_.size(), (chunk + 1) * kCellsPerChunk);
    for (std::size_t i = chunk * kCellsPerChunk; i < end; ++i) {
      int neighbours = 0;
      const Plane plane = plane_of(around(table_.cells()[i], neighbours));
      cells_[i] = {(moments_[i].sum / moments_[i].count).cast<float>(), plane.normal};
      thickness[i] = plane.thickness;
      crowded[i] = neighbours >= kMinSolidNeighbours;
    }
  });
  find_solids(crowded);
  thickness_ = median_of_flat(thickness);
}

double SurfaceLevel::median_of_flat(const std::vector<double>& values) const {
  std::vector<double> flat;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (cells_[i].is_flat()) flat.push_back(values[i]);
  }
  if (flat.empty()) return 0.0;
  std::nth_element(flat.begin(), flat.begin() + flat.size() / 2, flat.end());
  return flat[flat.size() / 2];
}

void SurfaceLevel::find_solids(const std::vector<char>& crowded) {
  std::vector<double> counts;
  for (const Moments& moments : moments_) counts.push_back(moments.count);
  const double least = std::max(kMinSolidPoints, kMinSolidShare * median_of_flat(counts));
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    cells_[i].is_solid = !cells_[i].is_flat() && crowded[i] != 0 && moments_[i].count >= least;
  }
}

void SurfaceLevel::orient(const std::function<bool(const Eigen::Vector3d&)>& is_free) {
  StopLook stop;
  for (SurfaceCell& cell : cells_) {
    stop.step();
    if (!cell.is_flat()) continue;
    const auto is_open = [&](double side) {
      const Eigen::Vector3d step = side * size_ * cell.normal.cast<double>();
      const Eigen::Vector3d p = cell.mean.cast<double>();
      return is_free(p + kNearSide * step) || is_free(p + kFarSide * step);
    };
    const bool ahead = is_open(1.0);
    cell.one_sided = ahead != is_open(-1.0);
    if (cell.one_sided && !ahead) cell.normal = -cell.normal;
  }
}

const SurfaceCell* SurfaceLevel::nearest(const Eigen::Vector3d& p) const {
  const VoxelIndex low = cell_of(p.array() - 0.5 * size_, per_metre_);
  const Eigen::Vector3f q = p.cast<float>();
  CellTable::Cursor cursor(table_);
  const SurfaceCell* best = nullptr;
  float least = 0.0F;
  for (int step = 0; step < 8; ++step) {
    const int found = cursor.find({low.x + (step & 1), low.y + (step >> 1 & 1), low.z + (step >> 2)});
    if (found < 0) continue;
    const float squared = (cells_[found].mean - q).squaredNorm();
    if (best == nullptr || squared < least) {
      best = &cells_[found];
      least = squared;
    }
  }
  return best;
}

}  // namespace concord
