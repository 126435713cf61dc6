#include "view/view_region.hpp"

#include <algorithm>
#include <cmath>

namespace concord::hmd {
namespace {

double edge_of(const ViewRegion& region, int level) { return region.resolution * 64 * static_cast<double>(1 << level); }

}  // namespace

double distance_to(const ViewRegion& region, const BlockKey& key) {
  const double edge = edge_of(region, key.level);
  const Eigen::Vector3d low = Eigen::Vector3d(key.index.x, key.index.y, key.index.z) * edge;
  const Eigen::Vector3d nearest = region.centre.cwiseMax(low).cwiseMin((low.array() + edge).matrix());
  return (nearest - region.centre).norm();
}

bool in_view(const ViewRegion& region, const BlockKey& key) {
  const int coarsest = static_cast<int>(region.radii.size()) - 1;
  if (key.level > coarsest) return false;
  if (region.z) {
    const double edge = edge_of(region, key.level), low = key.index.z * edge;
    if (low >= (*region.z)[1] || low + edge <= (*region.z)[0]) return false;
  }
  BlockKey up = key;
  if (key.level > 0 && distance_to(region, key) < region.radii[static_cast<std::size_t>(key.level - 1)]) return false;
  for (; up.level < coarsest; ++up.level) {
    up.index = {up.index.x >> 1, up.index.y >> 1, up.index.z >> 1};
    const BlockKey parent{up.level + 1, up.index};
    if (distance_to(region, parent) >= region.radii[static_cast<std::size_t>(up.level)]) return false;
  }
  return distance_to(region, up) < region.radii.back();
}

}  // namespace concord::hmd
