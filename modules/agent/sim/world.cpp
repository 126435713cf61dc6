#include "agent/sim/world.hpp"

#include <cmath>

namespace concord {
namespace {

constexpr double kTouch = 1e-9;  // faces that lie on a voxel border belong to the voxels inside, whatever the rounding

/// A turned rectangle against an axis-parallel square, both in the plane.
struct Footprint {
  double cx, cy, hx, hy, cos, sin;

  explicit Footprint(const Solid& s)
      : cx(s.centre.x()),
        cy(s.centre.y()),
        hx(s.half.x()),
        hy(s.half.y()),
        cos(std::cos(s.yaw)),
        sin(std::sin(s.yaw)) {}

  /// Their insides overlap (separating axes).
  [[nodiscard]] bool overlaps(double x, double y, double half) const {
    const double dx = x - cx, dy = y - cy;
    const double along = std::abs(cos), across = std::abs(sin);
    return std::abs(dx) < half + along * hx + across * hy && std::abs(dy) < half + across * hx + along * hy &&
           std::abs(cos * dx + sin * dy) < hx + half * (along + across) &&
           std::abs(cos * dy - sin * dx) < hy + half * (along + across);
  }

  /// The whole square lies strictly inside.
  [[nodiscard]] bool encloses(double x, double y, double half) const {
    const double dx = x - cx, dy = y - cy;
    const double reach = half * (std::abs(cos) + std::abs(sin));
    return std::abs(cos * dx + sin * dy) + reach < hx && std::abs(cos * dy - sin * dx) + reach < hy;
  }
};

void insert_surface(VoxelSet& set, const Solid& solid, double resolution, const Eigen::AlignedBox3d& region) {
  const Footprint footprint(solid);
  const Eigen::AlignedBox3d box = bounds(solid);
  const VoxelIndex low = voxel_of(box.min(), resolution), high = voxel_of(box.max(), resolution);
  const double within = resolution / 2 - kTouch, around = resolution / 2 + kTouch;
  for (std::int32_t y = low.y; y <= high.y; ++y) {
    for (std::int32_t x = low.x; x <= high.x; ++x) {
      const Eigen::Vector3d column = centre_of({x, y, 0}, resolution);
      if (!footprint.overlaps(column.x(), column.y(), within)) continue;
      const bool inside_xy = footprint.encloses(column.x(), column.y(), around);
      for (std::int32_t z = low.z; z <= high.z; ++z) {
        const Eigen::Vector3d centre = centre_of({x, y, z}, resolution);
        const double dz = std::abs(centre.z() - solid.centre.z());
        const bool overlaps_z = dz < solid.half.z() + within;
        const bool inside = inside_xy && dz + around < solid.half.z();
        if (overlaps_z && !inside && region.contains(centre)) set.insert({x, y, z});
      }
    }
  }
}

}  // namespace

Eigen::AlignedBox3d bounds(const Solid& solid) {
  const double c = std::abs(std::cos(solid.yaw)), s = std::abs(std::sin(solid.yaw));
  const Eigen::Vector3d half(c * solid.half.x() + s * solid.half.y(), s * solid.half.x() + c * solid.half.y(),
                             solid.half.z());
  return {solid.centre - half, solid.centre + half};
}

VoxelSet surface(const World& world, double resolution) {
  const Eigen::AlignedBox3d everywhere(Eigen::Vector3d::Constant(-1e6), Eigen::Vector3d::Constant(1e6));
  VoxelSet set;
  for (const Solid& solid : world.solids) insert_surface(set, solid, resolution, everywhere);
  return set;
}

VoxelSet surface(const World& world, const Feature& feature, double resolution) {
  VoxelSet set;
  for (const std::size_t solid : feature.solids) insert_surface(set, world.solids[solid], resolution, feature.region);
  return set;
}

}  // namespace concord
