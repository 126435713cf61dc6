#include "core/pins.hpp"

#include <algorithm>

namespace concord {

void PinMap::set(VoxelIndex voxel, Pin pin) {
  const BrickIndex index = brick_of(voxel);
  if (pin == Pin::kNone && !bricks_.contains(index)) return;
  const int local = local_of(voxel);
  const std::uint64_t bit = std::uint64_t{1} << (local % 64);
  PinBrick& brick = bricks_[index];
  brick.occupied[local / 64] &= ~bit;
  brick.free[local / 64] &= ~bit;
  if (pin == Pin::kAdded) brick.occupied[local / 64] |= bit;
  if (pin == Pin::kDeleted) brick.free[local / 64] |= bit;
  if (brick == PinBrick{}) bricks_.erase(index);
}

bool PinMap::set(BrickIndex index, const PinBrick& pins) {
  if (pins == PinBrick{}) return bricks_.erase(index) != 0;
  const auto [it, created] = bricks_.try_emplace(index, pins);
  if (created) return true;
  if (it->second == pins) return false;
  it->second = pins;
  return true;
}

PinMap::Pin PinMap::at(VoxelIndex voxel) const {
  const PinBrick* brick = find(brick_of(voxel));
  if (brick == nullptr) return Pin::kNone;
  const int local = local_of(voxel);
  if ((brick->occupied[local / 64] >> (local % 64) & 1) != 0) return Pin::kAdded;
  if ((brick->free[local / 64] >> (local % 64) & 1) != 0) return Pin::kDeleted;
  return Pin::kNone;
}

const PinBrick* PinMap::find(BrickIndex index) const {
  const auto it = bricks_.find(index);
  return it != bricks_.end() ? &it->second : nullptr;
}

std::vector<BrickIndex> PinMap::sorted_bricks() const {
  std::vector<BrickIndex> indices;
  indices.reserve(bricks_.size());
  for (const auto& [index, brick] : bricks_) indices.push_back(index);
  std::sort(indices.begin(), indices.end());
  return indices;
}

}  // namespace concord
