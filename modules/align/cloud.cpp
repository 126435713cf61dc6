#include "align/cloud.hpp"

#include <algorithm>
#include <utility>

#include "align/cell_table.hpp"
#include "align/surface.hpp"

namespace concord {
namespace {

/// Of the 27 cells around a point of a plane 9 are taken; of a scan's rings fewer.
constexpr int kSurface = 6;
constexpr std::size_t kManyPoints = 1'000'000;

bool is_surface_at(std::span<const Eigen::Vector3f> points, double resolution) {
  if (are_scattered(points, resolution)) return false;
  CellTable cells;
  for (const Eigen::Vector3f& p : points) cells.insert(cell_of(p.cast<double>(), 1.0 / resolution));
  CellTable::Cursor cursor(cells);
  std::size_t dense = 0;
  for (const Eigen::Vector3f& p : points) {
    const VoxelIndex at = cell_of(p.cast<double>(), 1.0 / resolution);
    int taken = 0;
    for (int step = 0; step < 27; ++step) {
      taken += cursor.find({at.x + step % 3 - 1, at.y + step / 3 % 3 - 1, at.z + step / 9 - 1}) >= 0 ? 1 : 0;
    }
    if (taken >= kSurface) ++dense;
  }
  return 2 * dense >= points.size();
}

}  // namespace

std::vector<Eigen::Vector3f> thinned(std::vector<Eigen::Vector3f> points, double resolution) {
  const double edge = 0.5 * resolution;
  if (are_scattered(points, edge)) return points;
  CellTable cells;
  std::vector<Eigen::Vector4d> sums;
  for (const Eigen::Vector3f& p : points) {
    const auto number = static_cast<std::size_t>(cells.insert(cell_of(p.cast<double>(), 1.0 / edge)));
    if (number == sums.size()) sums.emplace_back(Eigen::Vector4d::Zero());
    sums[number] += Eigen::Vector4d(p.x(), p.y(), p.z(), 1.0);
  }
  std::vector<Eigen::Vector3f> means;
  means.reserve(sums.size());
  for (const Eigen::Vector4d& sum : sums) means.emplace_back((sum.head<3>() / sum.w()).cast<float>());
  return means;
}

PreparedCloud prepare_cloud(std::vector<Eigen::Vector3f> points) {
  const auto* at = std::find_if(std::begin(kAlignResolutions), std::end(kAlignResolutions) - 1,
                                [&](double resolution) { return is_surface_at(points, resolution); });
  PreparedCloud out{std::move(points), *at};
  if (out.points.size() > kManyPoints) out.points = thinned(std::move(out.points), out.resolution);
  return out;
}

}  // namespace concord
