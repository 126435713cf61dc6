#include "core/lattice_transform.hpp"

#include <cmath>

namespace concord {
namespace {

constexpr double kWholeBrick = 1e-3;  // voxels

std::array<FixedPoint, 3> fixed_columns(const Eigen::Matrix3d& m) {
  std::array<FixedPoint, 3> columns;
  for (int step = 0; step < 3; ++step) {
    for (int axis = 0; axis < 3; ++axis) {
      columns[step][axis] = static_cast<std::int32_t>(std::lround(std::ldexp(m(axis, step), kFractionBits)));
    }
  }
  return columns;
}

PullSteps pull_steps(const std::array<FixedPoint, 3>& steps) {
  PullSteps out;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = [&](int x, int y, int z) { return x * steps[0][axis] + y * steps[1][axis] + z * steps[2][axis]; };
    for (int i = 0; i < 64; ++i) out.block[axis][i] = at(2 * (i & 3), 2 * (i >> 2 & 3), 2 * (i >> 4));
    for (int i = 0; i < 8; ++i) out.lane[axis][i] = at(i & 1, i >> 1 & 1, i >> 2);
    out.half[axis] = at(1, 1, 1) / 2;
  }
  return out;
}

std::optional<BrickIndex> whole_bricks(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  const double turn = (rotation - Eigen::Matrix3d::Identity()).cwiseAbs().rowwise().sum().maxCoeff() * kMaxVoxel;
  const Eigen::Vector3d bricks = (translation / kBrickSide).array().round();
  const double rest = (translation - bricks * kBrickSide).cwiseAbs().maxCoeff();
  if (turn > kWholeBrick || rest > kWholeBrick || bricks.cwiseAbs().maxCoeff() > kMaxVoxel) return std::nullopt;
  return BrickIndex{static_cast<std::int32_t>(bricks.x()), static_cast<std::int32_t>(bricks.y()),
                    static_cast<std::int32_t>(bricks.z())};
}

}  // namespace

LatticeTransform::LatticeTransform(const Transform& T_map_layer, double resolution)
    : rotation_(T_map_layer.linear()),
      translation_(T_map_layer.translation() / resolution),
      half_abs_rotation_(0.5 * rotation_.cwiseAbs()),
      forward_steps_(fixed_columns(rotation_)),
      inverse_steps_(fixed_columns(rotation_.transpose())),
      pull_steps_(concord::pull_steps(inverse_steps_)),
      brick_shift_(whole_bricks(rotation_, translation_)) {}

Eigen::Vector3d LatticeTransform::to_map(const Eigen::Vector3d& p_layer) const {
  return rotation_ * p_layer + translation_;
}

Eigen::Vector3d LatticeTransform::to_layer(const Eigen::Vector3d& p_map) const {
  return rotation_.transpose() * (p_map - translation_);
}

Eigen::Vector3d LatticeTransform::half_extent_in_map(const Eigen::Vector3d& size) const {
  return half_abs_rotation_ * size;
}

Eigen::Vector3d LatticeTransform::half_extent_in_layer(const Eigen::Vector3d& size) const {
  return half_abs_rotation_.transpose() * size;
}

LatticeTransform::Reach LatticeTransform::reach_of(VoxelIndex origin, int side) const {
  const double half = 0.5 * side;
  const Eigen::Vector3d centre = to_map({origin.x + half, origin.y + half, origin.z + half});
  // Whole bricks keep clear of their neighbours; otherwise a little more, so that rounding cannot lose a voxel.
  const double margin = brick_shift_.has_value() ? -0.25 : 0.01;
  const Eigen::Vector3d extent = half_extent_in_map(Eigen::Vector3d::Constant(side)).array() + margin;
  return {centre - extent, centre + extent};
}

void LatticeTransform::touch(VoxelIndex origin, int side, BrickSet& out) const {
  const Reach reach = reach_of(origin, side);
  const Eigen::Vector3d low = reach.low.cwiseMax(-kMaxVoxel);
  const Eigen::Vector3d high = reach.high.cwiseMin(kMaxVoxel - 0.5);
  if ((low.array() > high.array()).any()) return;
  out.insert_box(brick_of(voxel_of(low, 1.0)), brick_of(voxel_of(high, 1.0)));
}

bool LatticeTransform::keeps_in_bounds(BrickIndex source) const {
  const Reach reach = reach_of(origin_of(source), kBrickSide);
  return reach.low.minCoeff() >= -kMaxVoxel && reach.high.maxCoeff() <= kMaxVoxel;
}

}  // namespace concord
