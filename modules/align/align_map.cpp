#include "align/align_map.hpp"

#include <cmath>
#include <string>

#include <Eigen/Eigenvalues>

#include "align/workers.hpp"
#include "core/decimal.hpp"

namespace concord {
namespace {

constexpr double kMinFineCell = 0.1;  // metres: below it normals are those of the voxels' own edges
constexpr double kMiddleCell = 0.25;
constexpr double kCoarseCell = 0.5;
constexpr double kMaxFineCell = 2.0;

constexpr double kMaxTilt = 4.5 * M_PI / 180.0;
constexpr double kMinUprightCells = 100;

/// With fewer free blocks than this for each cell of surface, a map was made without free space.
constexpr double kMinFreeShare = 0.2;

/// Of a cell: thicker surfaces have noise or strays about them.
constexpr double kNoisy = 0.12;
constexpr int kStrayRounds = 2;

bool is_noisy(const SurfaceLevel& level) { return level.thickness() > kNoisy * level.size(); }

Result<AlignMap> make(Result<SurfacePoints> points, double resolution, int threads) {
  if (!points) return tl::unexpected(points.error());
  if (are_scattered(*points, resolution)) {
    return refuse(Code::kTooLarge, "the surface is scattered over too much space; align a coarser copy of the map");
  }
  AlignMap out;
  out.resolution = resolution;
  out.points = without_loners(std::move(*points), resolution, threads);
  out.levels = make_levels(out.points, resolution, threads);
  for (int round = 0; round < kStrayRounds && is_noisy(out.fine()); ++round) {
    out.points = out.fine().without_strays(out.points, threads);
    out.levels = make_levels(out.points, resolution, threads);
  }
  out.R_upright_map = upright(out.levels.size() > 1 ? out.levels[1] : out.levels[0]);
  return out;
}

void orient(AlignMap& map) {
  for (SurfaceLevel& level : map.levels) {
    level.orient([&](const Eigen::Vector3d& p) { return map.free.contains(p); });
  }
}

bool usable(double resolution) {
  return std::isfinite(resolution) && resolution >= kMinAlignResolution && resolution <= 0.5 * kMaxFineCell;
}

tl::unexpected<Error> refuse_resolution(double resolution) {
  return refuse(Code::kBadResolution, "maps are aligned at 0.02 to 1 m, this one has " + decimal(resolution));
}

}  // namespace

std::vector<SurfaceLevel> make_levels(const SurfacePoints& points, double resolution, int threads) {
  std::vector<SurfaceLevel> levels;
  levels.emplace_back(points, std::max(2.0 * resolution, kMinFineCell), threads);
  for (const double size : {kMiddleCell, kCoarseCell}) {
    if (size > 1.4 * levels.back().size()) levels.emplace_back(levels.back(), size, threads);
  }
  return levels;
}

Eigen::Matrix3d upright(const SurfaceLevel& surface) {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  for (const double degrees : {12.0, 6.0, 3.0, 2.0, 2.0}) {
    const double gate = std::sin(degrees * M_PI / 180.0);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    double count = 0.0;
    StopLook stop;
    for (const SurfaceCell& cell : surface.cells()) {
      stop.step();
      if (!cell.is_flat()) continue;
      const Eigen::Vector3d n = cell.normal.cast<double>();
      const double along = n.dot(up);
      if (1.0 - along * along < gate * gate) {
        sum += n * n.transpose();
      } else if (std::abs(along) < gate) {
        sum -= n * n.transpose();
      } else {
        continue;
      }
      count += 1.0;
    }
    if (count < kMinUprightCells) return Eigen::Matrix3d::Identity();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum);
    const Eigen::Vector3d best = solver.eigenvectors().col(2);
    // Without level ground one direction along the walls is as good as another.
    if (solver.eigenvalues()[2] - solver.eigenvalues()[1] < 0.05 * count) return Eigen::Matrix3d::Identity();
    up = best.z() < 0.0 ? Eigen::Vector3d(-best) : best;
  }
  if (up.z() < std::cos(kMaxTilt)) return Eigen::Matrix3d::Identity();
  return Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

Result<AlignMap> make_align_map(const BrickMap& map, double resolution, int threads) {
  if (!usable(resolution)) return refuse_resolution(resolution);
  Result<AlignMap> out = make(surface_points(map, resolution), resolution, threads);
  if (!out) return out;
  out->free = ObservedFreeSpace::known(map, resolution);
  if (static_cast<double>(out->free.block_count()) < kMinFreeShare * static_cast<double>(out->fine().cells().size())) {
    out->free = ObservedFreeSpace::implied(out->fine(), threads);
  }
  orient(*out);
  return out;
}

Result<AlignMap> make_align_map(std::span<const Eigen::Vector3f> cloud, double resolution, int threads) {
  if (!usable(resolution)) return refuse_resolution(resolution);
  Result<AlignMap> out = make(surface_points(cloud), resolution, threads);
  if (!out) return out;
  out->free = ObservedFreeSpace::implied(out->fine(), threads);
  orient(*out);
  return out;
}

AlignMap mirrored(const AlignMap& map, int threads) {
  const Eigen::Vector3d mirror(-1.0, 1.0, 1.0);
  AlignMap out;
  out.resolution = map.resolution;
  out.points = map.points;
  for (Eigen::Vector3f& p : out.points) p.x() = -p.x();
  out.levels = make_levels(out.points, map.resolution, threads);
  out.free = map.free.mirrored();
  out.R_upright_map = mirror.asDiagonal() * map.R_upright_map * mirror.asDiagonal();
  orient(out);
  return out;
}

}  // namespace concord
