#pragma once

#include <octomap/octomap.h>

#include "core/brick_map.hpp"
#include "core/transform.hpp"

namespace concord::bench {

/// The peer: merging as the papers' code does it, written plainly on OctoMap. One running tree of log-odds and one of
/// weights; each leaf of a submap is expanded to the map's resolution, and each of its voxels is transformed, searched
/// in both trees, averaged (SLAM-XR eq. 1, in log-odds) and written to both.
class PapersMerge {
 public:
  explicit PapersMerge(double resolution);

  void add(const octomap::OcTree& submap, const Transform& T_map_submap, float weight);

  [[nodiscard]] const octomap::OcTree& map() const { return map_; }
  [[nodiscard]] const octomap::OcTree& weights() const { return weights_; }

 private:
  void add_voxel(const octomap::point3d& p_map, float log_odds, float weight);

  octomap::OcTree map_;
  octomap::OcTree weights_;
};

/// The same content as an octree, pruned, as a robot sends it.
[[nodiscard]] octomap::OcTree to_octree(const BrickMap& map, double resolution);

/// Voxels of the tree's own resolution, those of pruned leaves counted one by one.
[[nodiscard]] std::size_t known_count(const octomap::OcTree& tree);

}  // namespace concord::bench
