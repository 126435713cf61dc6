#include "semantic/brick_masks.hpp"

#include <algorithm>
#include <bit>

namespace concord {

BrickMasks& BrickMasks::operator=(const BrickMasks& other) {
  bricks_ = other.bricks_;
  last_ = nullptr;
  return *this;
}

BrickMasks& BrickMasks::operator=(BrickMasks&& other) noexcept {
  bricks_ = std::exchange(other.bricks_, {});
  last_ = std::exchange(other.last_, nullptr);
  return *this;
}

void BrickMasks::insert_column(std::int32_t x, std::int32_t y, std::int32_t first, std::int32_t last) {
  for (std::int32_t z = first; z <= last; ++z) insert(VoxelIndex{x, y, z});
}

void BrickMasks::insert(BrickIndex index, const VoxelMask& voxels) {
  VoxelMask& mask = brick(index);
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] |= voxels[i];
}

void BrickMasks::insert(const BrickMasks& other) {
  for (const auto& [index, voxels] : other.bricks_) insert(index, voxels);
}

void BrickMasks::erase(const BrickMasks& other) {
  for (auto& [index, mask] : bricks_) {
    const VoxelMask* gone = other.find(index);
    for (std::size_t i = 0; gone != nullptr && i < mask.size(); ++i) mask[i] &= ~(*gone)[i];
  }
}

bool BrickMasks::contains(VoxelIndex voxel) const {
  const VoxelMask* mask = find(brick_of(voxel));
  return mask != nullptr && ((*mask)[local_of(voxel) / 64] & bit_of(voxel)) != 0;
}

const VoxelMask* BrickMasks::find(BrickIndex index) const {
  const auto it = bricks_.find(index);
  return it != bricks_.end() ? &it->second : nullptr;
}

std::int64_t BrickMasks::count() const {
  std::int64_t count = 0;
  for (const auto& [index, mask] : bricks_) {
    for (const std::uint64_t word : mask) count += std::popcount(word);
  }
  return count;
}

std::vector<std::pair<BrickIndex, VoxelMask>> BrickMasks::sorted() const {
  std::vector<std::pair<BrickIndex, VoxelMask>> out;
  out.reserve(bricks_.size());
  for (const auto& [index, mask] : bricks_) {
    if (mask != VoxelMask{}) out.emplace_back(index, mask);
  }
  std::ranges::sort(out, {}, [](const auto& entry) { return entry.first; });
  return out;
}

std::vector<VoxelIndex> BrickMasks::voxels() const {
  std::vector<VoxelIndex> out;
  out.reserve(static_cast<std::size_t>(count()));
  for (const auto& [index, mask] : bricks_) {
    for (int word = 0; word < 8; ++word) {
      for (std::uint64_t bits = mask[word]; bits != 0; bits &= bits - 1) {
        out.push_back(voxel_at(index, word * 64 + std::countr_zero(bits)));
      }
    }
  }
  std::ranges::sort(out);
  return out;
}

BrickMap BrickMasks::to_map(LogOdds value) const {
  BrickMap map;
  for (const auto& [index, mask] : sorted()) map.set(index, Brick::uniform(mask, value));
  return map;
}

std::optional<VoxelBox> bounds_of(const BrickMasks& voxels) {
  const std::vector<VoxelIndex> all = voxels.voxels();
  if (all.empty()) return std::nullopt;
  VoxelBox box{all.front(), all.front()};
  for (const VoxelIndex v : all) {
    box.min = {std::min(box.min.x, v.x), std::min(box.min.y, v.y), std::min(box.min.z, v.z)};
    box.max = {std::max(box.max.x, v.x), std::max(box.max.y, v.y), std::max(box.max.z, v.z)};
  }
  return box;
}

BrickMasks occupied_of(const BrickMap& map) {
  BrickMasks out;
  map.for_each_brick([&](BrickIndex index, const Brick& brick) {
    const VoxelMask occupied = brick.occupied();
    if (occupied != VoxelMask{}) out.insert(index, occupied);
  });
  return out;
}

BrickMasks occupied_around(const BrickMap& map, const VoxelBox& box) {
  const BrickIndex first = brick_of(box.min), last = brick_of(box.max);
  BrickMasks out;
  const auto take = [&](BrickIndex index, const Brick& brick) {
    const VoxelMask occupied = brick.occupied();
    if (occupied != VoxelMask{}) out.insert(index, occupied);
  };
  const auto side = [](std::int32_t from, std::int32_t to) { return std::int64_t{to} - from + 1; };
  const std::int64_t bricks = side(first.x, last.x) * side(first.y, last.y) * side(first.z, last.z);
  if (bricks > static_cast<std::int64_t>(map.brick_count())) {
    map.for_each_brick([&](BrickIndex index, const Brick& brick) {
      const auto is_in = [](std::int32_t at, std::int32_t from, std::int32_t to) { return at >= from && at <= to; };
      if (is_in(index.x, first.x, last.x) && is_in(index.y, first.y, last.y) && is_in(index.z, first.z, last.z)) {
        take(index, brick);
      }
    });
    return out;
  }
  for (BrickIndex at = first; at.x <= last.x; ++at.x) {
    for (at.y = first.y; at.y <= last.y; ++at.y) {
      for (at.z = first.z; at.z <= last.z; ++at.z) {
        if (const Brick* brick = map.find(at); brick != nullptr) take(at, *brick);
      }
    }
  }
  return out;
}

BrickMasks masks_of(const std::vector<VoxelIndex>& voxels) {
  BrickMasks out;
  for (const VoxelIndex voxel : voxels) out.insert(voxel);
  return out;
}

}  // namespace concord
