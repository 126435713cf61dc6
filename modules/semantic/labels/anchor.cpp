#include "semantic/labels/anchor.hpp"

#include <algorithm>
#include <bit>

#include "core/lattice_transform.hpp"

namespace concord {
namespace {

/// A placement that was said twice may differ in its last bits.
constexpr double kSamePlace = 1e-9;

Eigen::Vector3d centre(VoxelIndex v) { return {v.x + 0.5, v.y + 0.5, v.z + 0.5}; }
VoxelIndex holding(const Eigen::Vector3d& p) { return voxel_of(p, 1.0); }

/// What voxels of one lattice are in another: those that hold a centre of one, and those whose own centre lies in one.
/// `there` and `back` take a point of one lattice to the other's, in voxels.
template <class There, class Back>
BrickMasks carried(const std::vector<VoxelIndex>& voxels, There there, Back back) {
  BrickMasks out;
  for (const VoxelIndex from : voxels) {
    const Eigen::Vector3d at = there(centre(from));
    const VoxelIndex to = holding(at);
    if (in_bounds(to)) out.insert(to);
    // A centre in a cube of side 1 is less than 0.87 from the cube's own.
    for (int i = 0; i < 27; ++i) {
      const VoxelIndex beside{to.x + i % 3 - 1, to.y + i / 3 % 3 - 1, to.z + i / 9 - 1};
      if ((centre(beside) - at).squaredNorm() > 1.0) continue;
      if (in_bounds(beside) && holding(back(centre(beside))) == from) out.insert(beside);
    }
  }
  return out;
}

std::vector<VoxelIndex> voxels_of(const std::vector<std::pair<BrickIndex, VoxelMask>>& bricks) {
  BrickMasks all;
  for (const auto& [index, mask] : bricks) all.insert(index, mask);
  return all.voxels();
}

}  // namespace

LabelAnchor anchor_of(const std::vector<VoxelIndex>& voxels, const AgentLayers& layers, double resolution) {
  LabelAnchor best;
  std::size_t most = 0;
  for (const auto& [agent, layer] : layers) {
    if (!layer.T_map_agent) continue;
    const LatticeTransform lattice(*layer.T_map_agent, resolution);
    const auto count = static_cast<std::size_t>(std::ranges::count_if(voxels, [&, &map = layer.map](VoxelIndex v) {
      const VoxelIndex own = holding(lattice.to_layer(centre(v)));
      return in_bounds(own) && is_occupied(map.at(own));
    }));
    if (count <= most || 2 * count < voxels.size()) continue;
    most = count;
    best = {agent, layer.frame_id, *layer.T_map_agent};
  }
  return best;
}

BrickMasks followed(const std::vector<std::pair<BrickIndex, VoxelMask>>& claimed, const Transform& T_map_agent_then,
                    const Transform& T_map_agent_now, double resolution) {
  if ((T_map_agent_then.matrix() - T_map_agent_now.matrix()).cwiseAbs().maxCoeff() < kSamePlace) {
    BrickMasks same;
    for (const auto& [index, mask] : claimed) same.insert(index, mask);
    return same;
  }
  const LatticeTransform then(T_map_agent_then, resolution), now(T_map_agent_now, resolution);
  const BrickMasks own = carried(
      voxels_of(claimed), [&](const auto& p) { return then.to_layer(p); },
      [&](const auto& p) { return then.to_map(p); });
  return carried(
      own.voxels(), [&](const auto& p) { return now.to_map(p); }, [&](const auto& p) { return now.to_layer(p); });
}

}  // namespace concord
