#include "agent/sim/voxel_set.hpp"

namespace concord {

void VoxelSet::insert(VoxelIndex voxel) {
  const int local = local_of(voxel);
  masks_[brick_of(voxel)][local / 64] |= std::uint64_t{1} << (local % 64);
}

bool VoxelSet::contains(VoxelIndex voxel) const {
  const auto it = masks_.find(brick_of(voxel));
  if (it == masks_.end()) return false;
  const int local = local_of(voxel);
  return (it->second[local / 64] >> (local % 64) & 1) != 0;
}

bool VoxelSet::contains_near(VoxelIndex voxel) const {
  if (contains(voxel)) return true;
  for (std::int32_t dz = -1; dz <= 1; ++dz) {
    for (std::int32_t dy = -1; dy <= 1; ++dy) {
      for (std::int32_t dx = -1; dx <= 1; ++dx) {
        if (contains({voxel.x + dx, voxel.y + dy, voxel.z + dz})) return true;
      }
    }
  }
  return false;
}

std::size_t VoxelSet::size() const {
  std::size_t count = 0;
  for (const auto& [brick, mask] : masks_) {
    for (const std::uint64_t word : mask) count += static_cast<std::size_t>(std::popcount(word));
  }
  return count;
}

BrickMap VoxelSet::to_map() const {
  BrickMap map;
  for (const auto& [brick, mask] : masks_) map.set(brick, Brick::uniform(mask, kOccupied));
  return map;
}

VoxelSet occupied_voxels(const BrickMap& map) {
  VoxelSet set;
  map.for_each_brick([&](BrickIndex index, const Brick& brick) {
    const VoxelMask mask = brick.occupied();
    for (int local = 0; local < kBrickVoxels; ++local) {
      if ((mask[local / 64] >> (local % 64) & 1) != 0) set.insert(voxel_at(index, local));
    }
  });
  return set;
}

}  // namespace concord
