#include "oracle.hpp"

#include <cmath>

namespace concord::testing {
namespace {

constexpr double kTolerance = 1e-4;  // of a voxel; stricter than of a metre

struct Claim {
  LogOdds value = kUnknown;
  bool may_differ = false;
};
using Claims = std::map<VoxelIndex, Claim>;

bool near_boundary(const Eigen::Vector3d& p) { return ((p.array() - p.array().round()).abs() < kTolerance).any(); }

template <class Visit>
void visit_around(VoxelIndex centre, Visit&& visit) {
  for (int z = -1; z <= 1; ++z) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) visit(VoxelIndex{centre.x + x, centre.y + y, centre.z + z});
    }
  }
}

/// A map voxel whose centre lies in a source voxel is at most 0.87 voxels from that one's centre.
void look_up(const SceneLayer& layer, double resolution, Claims& claims) {
  const Transform T_layer_map = layer.T_map_layer.inverse();
  for (const auto& [source, value] : layer.voxels) {
    const VoxelIndex middle = voxel_of(layer.T_map_layer * centre_of(source, resolution), resolution);
    visit_around(middle, [&](VoxelIndex target) {
      if (claims.contains(target)) return;
      const Eigen::Vector3d p = T_layer_map * centre_of(target, resolution);
      const auto found = layer.voxels.find(voxel_of(p, resolution));
      const bool may_differ = near_boundary(p / resolution);
      if (found != layer.voxels.end()) {
        claims[target] = {found->second, may_differ};
      } else if (may_differ) {
        claims[target] = {kUnknown, true};
      }
    });
  }
}

void raise(const SceneLayer& layer, double resolution, Claims& claims) {
  for (const auto& [source, value] : layer.voxels) {
    if (!is_occupied(value)) continue;
    const Eigen::Vector3d p = layer.T_map_layer * centre_of(source, resolution);
    const VoxelIndex holder = voxel_of(p, resolution);
    if (near_boundary(p / resolution)) {
      visit_around(holder, [&](VoxelIndex target) { claims[target].may_differ = true; });
    }
    claims[holder].value = std::max(claims[holder].value, value);
  }
}

LogOdds mean_of(std::int64_t sum, std::int64_t weight) {
  const auto rounded = static_cast<std::int64_t>((2 * std::abs(sum) + weight) / (2 * weight));
  if (sum < 0) return static_cast<LogOdds>(rounded == 0 ? -1 : -rounded);
  return static_cast<LogOdds>(rounded);
}

struct Sums {
  std::int64_t sum = 0;
  std::int64_t weight = 0;
  LogOdds largest = kUnknown;
  bool occupied = false;
  bool free = false;
  bool may_differ = false;
};

}  // namespace

std::map<VoxelIndex, Expected> compose_by_rules(const Scene& scene, Policy policy) {
  std::map<VoxelIndex, Sums> sums;
  for (const SceneLayer& layer : scene.layers) {
    Claims claims;
    look_up(layer, scene.resolution, claims);
    raise(layer, scene.resolution, claims);
    for (const auto& [voxel, claim] : claims) {
      Sums& s = sums[voxel];
      s.may_differ |= claim.may_differ;
      if (!is_known(claim.value)) continue;
      s.sum += std::int64_t{layer.weight} * claim.value;
      s.weight += layer.weight;
      s.largest = std::max(s.largest, claim.value);
      s.occupied |= to_double(claim.value) >= 0.4;
      s.free |= to_double(claim.value) <= -0.4;
    }
  }
  std::map<VoxelIndex, Expected> out;
  for (const auto& [voxel, s] : sums) {
    Expected expected{kUnknown, s.occupied && s.free, s.may_differ};
    if (s.weight != 0) expected.value = policy == Policy::kMean ? mean_of(s.sum, s.weight) : s.largest;
    out[voxel] = expected;
  }
  for (const auto& [voxel, occupied] : scene.pinned) {
    out[voxel] = {occupied ? kPinnedOccupied : kPinnedFree, false, false};
  }
  return out;
}

}  // namespace concord::testing
