#include "papers_merge.hpp"

#include <cmath>
#include <limits>

#include "core/octomap_format.hpp"

namespace concord::bench {
namespace {

octomap::OcTreeKey key_of(VoxelIndex voxel) {
  const auto key = [](std::int32_t i) { return static_cast<octomap::key_type>(i - kOctomapOrigin); };
  return {key(voxel.x), key(voxel.y), key(voxel.z)};
}

}  // namespace

PapersMerge::PapersMerge(double resolution) : map_(resolution), weights_(resolution) {
  weights_.setClampingThresMax(1.0);  // a weight is no probability: let it grow
}

void PapersMerge::add(const octomap::OcTree& submap, const Transform& T_map_submap, float weight) {
  const double r = map_.getResolution();
  for (auto leaf = submap.begin_leafs(), end = submap.end_leafs(); leaf != end; ++leaf) {
    const int side = static_cast<int>(std::lround(leaf.getSize() / r));
    const octomap::point3d centre = leaf.getCoordinate();
    const double first = -0.5 * (side - 1);
    for (int z = 0; z < side; ++z) {
      for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
          const Eigen::Vector3d p_submap(centre.x() + (first + x) * r, centre.y() + (first + y) * r,
                                         centre.z() + (first + z) * r);
          const Eigen::Vector3d p = T_map_submap * p_submap;
          add_voxel(octomap::point3d(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())),
                    leaf->getLogOdds(), weight);
        }
      }
    }
  }
}

void PapersMerge::add_voxel(const octomap::point3d& p_map, float log_odds, float weight) {
  const octomap::OcTreeNode* node = map_.search(p_map);
  const octomap::OcTreeNode* weight_node = weights_.search(p_map);
  if (node == nullptr || weight_node == nullptr) {
    map_.setNodeValue(p_map, log_odds);
    weights_.setNodeValue(p_map, weight);
    return;
  }
  const float old_weight = weight_node->getLogOdds();
  const float total = old_weight + weight;
  map_.setNodeValue(p_map, (node->getLogOdds() * old_weight + log_odds * weight) / total);
  weights_.setNodeValue(p_map, total);
}

octomap::OcTree to_octree(const BrickMap& map, double resolution) {
  octomap::OcTree tree(resolution);
  map.for_each_brick([&](BrickIndex index, const Brick& brick) {
    brick.for_each([&](int local, LogOdds l) {
      tree.setNodeValue(key_of(voxel_at(index, local)), static_cast<float>(to_double(l)), true);
    });
  });
  tree.updateInnerOccupancy();
  tree.prune();
  return tree;
}

std::size_t known_count(const octomap::OcTree& tree) {
  std::size_t count = 0;
  for (auto leaf = tree.begin_leafs(), end = tree.end_leafs(); leaf != end; ++leaf) {
    count += std::size_t{1} << (3 * (kOctomapDepth - leaf.getDepth()));
  }
  return count;
}

}  // namespace concord::bench
