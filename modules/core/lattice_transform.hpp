#pragma once

#include <optional>

#include "core/brick_kernels.hpp"
#include "core/brick_set.hpp"
#include "core/transform.hpp"

namespace concord {

/// A rigid transform between two lattices of one resolution: how a layer lies in the map, in voxels.
///
/// Which cell holds which centre is decided in fixed point, from anchors that depend on the transform and on the tile
/// (pulling) or brick (pushing) alone. So the answer for a voxel is the same whatever else is computed with it, and it
/// differs from an evaluation in double precision only for centres within 1e-5 voxels of a cell's boundary.
class LatticeTransform {
 public:
  /// @pre the translation is less than 2^30 voxels.
  LatticeTransform(const Transform& T_map_layer, double resolution);

  /// Where the transform moves whole bricks to whole bricks (to within 1e-3 voxels anywhere in the map): by how many.
  [[nodiscard]] const std::optional<BrickIndex>& brick_shift() const { return brick_shift_; }

  /// Adds the map bricks that a brick of the layer may contribute to; those out of bounds are left out.
  void touch(BrickIndex source, BrickSet& out) const { touch(origin_of(source), kBrickSide, out); }
  /// The same for all bricks of a tile at once; a larger set than touching each of them.
  void touch(TileIndex source, BrickSet& out) const { touch(origin_of(origin_of(source)), kTileVoxelSide, out); }

  /// Whether all that a brick of the layer may contribute to lies in bounds.
  [[nodiscard]] bool keeps_in_bounds(BrickIndex source) const;

  /// Points in voxels.
  [[nodiscard]] Eigen::Vector3d to_map(const Eigen::Vector3d& p_layer) const;
  [[nodiscard]] Eigen::Vector3d to_layer(const Eigen::Vector3d& p_map) const;

  /// Half the extent, on each axis, of the axis-aligned box around an axis-aligned box of `size` from the other side.
  [[nodiscard]] Eigen::Vector3d half_extent_in_map(const Eigen::Vector3d& size) const;
  [[nodiscard]] Eigen::Vector3d half_extent_in_layer(const Eigen::Vector3d& size) const;

  /// [axis of the step] a step by one voxel, as seen on the other side.
  [[nodiscard]] const std::array<FixedPoint, 3>& forward_steps() const { return forward_steps_; }
  [[nodiscard]] const std::array<FixedPoint, 3>& inverse_steps() const { return inverse_steps_; }
  [[nodiscard]] const PullSteps& pull_steps() const { return pull_steps_; }

 private:
  struct Reach {
    Eigen::Vector3d low, high;  ///< voxels, map
  };
  /// Around all that a cube of the layer may contribute to.
  [[nodiscard]] Reach reach_of(VoxelIndex origin, int side) const;
  void touch(VoxelIndex origin, int side, BrickSet& out) const;

  Eigen::Matrix3d rotation_;
  Eigen::Vector3d translation_;  // voxels
  Eigen::Matrix3d half_abs_rotation_;
  std::array<FixedPoint, 3> forward_steps_;
  std::array<FixedPoint, 3> inverse_steps_;
  PullSteps pull_steps_;
  std::optional<BrickIndex> brick_shift_;
};

}  // namespace concord
