#pragma once

#include <map>

#include "lab.hpp"

namespace concord::hmd {

inline Pose pose_of(const Transform& T) {
  const Eigen::Vector3d p = T.translation();
  const Eigen::Quaterniond q(T.linear());
  return {{p.x(), p.y(), p.z()}, {q.x(), q.y(), q.z(), q.w()}};
}

inline Transform transform_of(const Json& pose) {
  const auto p = pose["position"].get<std::array<double, 3>>();
  const auto q = pose["rotation"].get<std::array<double, 4>>();
  return make_transform({p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}).value();
}

/// A map in voxels of 0.05 m as a device that has voxels sends it.
inline VoxelLook look_of(const BrickMap& map) {
  std::map<VoxelIndex, VoxelChunk> chunks;
  map.for_each_brick([&](BrickIndex index, const Brick& brick) {
    brick.for_each([&](int local, LogOdds value) {
      if (!is_occupied(value)) return;
      const VoxelIndex voxel = voxel_at(index, local), chunk{voxel.x >> 4, voxel.y >> 4, voxel.z >> 4};
      const auto cell = static_cast<std::size_t>((voxel.x & 15) + 16 * (voxel.y & 15) + 256 * (voxel.z & 15));
      VoxelChunk& into = chunks.try_emplace(chunk, VoxelChunk{chunk, {}, {}}).first->second;
      into.occupied[cell / 8] = static_cast<std::uint8_t>(into.occupied[cell / 8] | 1 << (cell % 8));
    });
  });
  VoxelLook look{0.05, 0.9, 0.2, Transform::Identity(), {}};
  for (const auto& [index, chunk] : chunks) look.chunks.push_back(chunk);
  return look;
}

}  // namespace concord::hmd
