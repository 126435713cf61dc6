#include "semantic/detections/object_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "semantic/models/solid_voxels.hpp"

namespace concord {
namespace {

constexpr double kMatched = 1.5;  ///< voxels: within one of it, or of its corner
constexpr std::int64_t kMostCells = 200'000'000;

/// The occupied voxels around a model, to be looked up often.
class Near {
 public:
  Near(const BrickMasks& occupied, double resolution, const Eigen::AlignedBox3d& box, double reach)
      : resolution_(resolution) {
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(reach + resolution);
    low_ = voxel_of(box.min() - margin, resolution);
    const VoxelIndex high = voxel_of(box.max() + margin, resolution);
    size_ = {high.x - low_.x + 1, high.y - low_.y + 1, high.z - low_.z + 1};
    const std::int64_t cells = std::int64_t{size_.x} * size_.y * size_.z;
    if (cells > kMostCells) return;  // nothing is near then: such a thing is no object
    cells_.assign(static_cast<std::size_t>(cells), 0);
    for (const auto& [index, mask] : occupied.sorted()) {
      const VoxelIndex o = origin_of(index);
      if (o.x + 7 < low_.x || o.x > high.x || o.y + 7 < low_.y || o.y > high.y || o.z + 7 < low_.z || o.z > high.z)
        continue;
      for (int local = 0; local < kBrickVoxels; ++local) {
        if ((mask[local / 64] >> (local % 64) & 1) == 0) continue;
        if (const auto at = place(voxel_at(index, local))) cells_[*at] = 1;
      }
    }
    const int most = static_cast<int>(std::ceil(reach / resolution));
    for (int z = -most; z <= most; ++z) {
      for (int y = -most; y <= most; ++y) {
        for (int x = -most; x <= most; ++x) offsets_.push_back({x, y, z});
      }
    }
    std::ranges::stable_sort(offsets_, {}, [](VoxelIndex d) { return d.x * d.x + d.y * d.y + d.z * d.z; });
  }

  /// The centre of the nearest within `reach` voxels, of equals the first.
  [[nodiscard]] std::optional<Eigen::Vector3d> nearest(const Eigen::Vector3d& p, double reach) const {
    const VoxelIndex v = voxel_of(p, resolution_);
    for (const VoxelIndex d : offsets_) {
      if (d.x * d.x + d.y * d.y + d.z * d.z > reach * reach) break;
      const VoxelIndex at{v.x + d.x, v.y + d.y, v.z + d.z};
      if (const auto cell = place(at); cell && cells_[*cell] != 0) return centre_of(at, resolution_);
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] std::optional<std::size_t> place(VoxelIndex v) const {
    const std::int32_t x = v.x - low_.x, y = v.y - low_.y, z = v.z - low_.z;
    if (x < 0 || y < 0 || z < 0 || x >= size_.x || y >= size_.y || z >= size_.z || cells_.empty()) return std::nullopt;
    return static_cast<std::size_t>(x) +
           static_cast<std::size_t>(size_.x) *
               (static_cast<std::size_t>(y) + static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(z));
  }

  double resolution_;
  VoxelIndex low_, size_;
  std::vector<std::uint8_t> cells_;
  std::vector<VoxelIndex> offsets_;
};

/// How well it lies there.
ObjectFit judged(const std::vector<Eigen::Vector3d>& p_model, const Near& near, const Transform& T) {
  ObjectFit fit;
  fit.T_map_model = T;
  std::size_t matched = 0;
  double sum = 0;
  for (const Eigen::Vector3d& p : p_model) {
    const Eigen::Vector3d p_map = T * p;
    if (const auto q = near.nearest(p_map, kMatched)) ++matched, sum += (*q - p_map).squaredNorm();
  }
  fit.matched = static_cast<double>(matched) / static_cast<double>(p_model.size());
  fit.rms = matched > 0 ? std::sqrt(sum / static_cast<double>(matched)) : 0.0;
  return fit;
}

/// Mean squared distance, voxels, of what lies farther than kMatched as if it lay there: within that, nearer is better.
double cost(const ObjectFit& fit, double resolution) {
  const double voxels = fit.rms / resolution;
  return fit.matched * voxels * voxels + (1 - fit.matched) * kMatched * kMatched;
}

/// One step; nothing if hardly anything is near.
std::optional<Transform> step(const std::vector<Eigen::Vector3d>& p_model, const Near& near, const Transform& T,
                              double reach) {
  std::vector<Eigen::Vector3d> from, to;
  for (const Eigen::Vector3d& p : p_model) {
    const Eigen::Vector3d p_map = T * p;
    const auto q = near.nearest(p_map, reach);
    if (!q) continue;
    from.push_back(p_map);
    to.push_back(*q);
  }
  if (from.size() < 10) return std::nullopt;
  const Eigen::Map<const Eigen::Matrix3Xd> a(from.front().data(), 3, static_cast<Eigen::Index>(from.size()));
  const Eigen::Map<const Eigen::Matrix3Xd> b(to.front().data(), 3, static_cast<Eigen::Index>(to.size()));
  Transform change = Transform::Identity();
  change.matrix() = Eigen::umeyama(a, b, false);
  if (!change.matrix().allFinite()) return std::nullopt;
  const Transform next = change * T;
  // Products of many rotations drift from being one.
  Transform out = Transform::Identity();
  out.linear() = Eigen::Quaterniond(next.linear()).normalized().toRotationMatrix();
  out.translation() = next.translation();
  return out;
}

}  // namespace

Result<std::vector<Eigen::Vector3d>> surface_points(const TriangleMesh& mesh, double scale, double resolution) {
  const auto voxels = voxelize(mesh, {Transform::Identity(), scale}, resolution / 2, Fill::kSurface);
  if (!voxels) return tl::unexpected(voxels.error());
  const auto all = voxels->surface.voxels();
  std::vector<Eigen::Vector3d> out;
  const std::size_t stride = std::max<std::size_t>(1, (all.size() + kMaxFitPoints - 1) / kMaxFitPoints);
  for (std::size_t i = 0; i < all.size(); i += stride) out.push_back(centre_of(all[i], resolution / 2));
  return out;
}

ObjectFit fit_object(const std::vector<Eigen::Vector3d>& p_model, const BrickMasks& occupied, double resolution,
                     const Transform& T_map_model, double reach) {
  Eigen::AlignedBox3d box;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : p_model) box.extend(T_map_model * p), middle += p;
  middle /= static_cast<double>(p_model.size());
  const Near near(occupied, resolution, box, 2 * reach);
  const ObjectFit before = judged(p_model, near, T_map_model);
  Transform T = T_map_model;
  const double farthest = reach / resolution;
  for (int i = 0; i < kFitSteps; ++i) {
    const auto next = step(p_model, near, T, std::max(kMatched, farthest * std::pow(0.8, i)));
    if (!next) return before;
    T = *next;
  }
  ObjectFit fit = judged(p_model, near, T);
  fit.shift = (T * middle - T_map_model * middle).norm();
  fit.turn = Eigen::AngleAxisd(T_map_model.linear().transpose() * T.linear()).angle();
  const bool is_bounded = fit.shift <= kFarthestFit && fit.turn <= kMostTurned;
  return is_bounded && cost(fit, resolution) < cost(before, resolution) ? fit : before;
}

}  // namespace concord
