#include "semantic/models/solid_voxels.hpp"

namespace concord {
namespace {

/// A box of voxels with one bit each, rows along z.
class BitBox {
 public:
  BitBox(VoxelIndex low, VoxelIndex high) : low_(low) {
    size_ = {high.x - low.x + 1, high.y - low.y + 1, high.z - low.z + 1};
    bits_.resize(static_cast<std::size_t>(size_.x) * size_.y * size_.z);
  }
  [[nodiscard]] bool at(VoxelIndex local) const { return bits_[place(local)]; }
  void set(VoxelIndex local) { bits_[place(local)] = true; }
  [[nodiscard]] VoxelIndex size() const { return size_; }
  [[nodiscard]] VoxelIndex low() const { return low_; }
  [[nodiscard]] VoxelIndex local(VoxelIndex voxel) const {
    return {voxel.x - low_.x, voxel.y - low_.y, voxel.z - low_.z};
  }

 private:
  [[nodiscard]] std::size_t place(VoxelIndex v) const {
    return (static_cast<std::size_t>(v.x) * size_.y + v.y) * size_.z + v.z;
  }
  VoxelIndex low_, size_;
  std::vector<bool> bits_;
};

/// Marks all that is reached from voxel 0, by runs along z.
void flood(BitBox& box) {
  std::vector<VoxelIndex> open{{0, 0, 0}};
  const VoxelIndex size = box.size();
  while (!open.empty()) {
    const VoxelIndex at = open.back();
    open.pop_back();
    if (box.at(at)) continue;
    std::int32_t first = at.z, last = at.z;
    while (first > 0 && !box.at({at.x, at.y, first - 1})) --first;
    while (last + 1 < size.z && !box.at({at.x, at.y, last + 1})) ++last;
    for (std::int32_t z = first; z <= last; ++z) box.set({at.x, at.y, z});
    for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      const std::int32_t x = at.x + dx, y = at.y + dy;
      if (x < 0 || y < 0 || x >= size.x || y >= size.y) continue;
      bool in_run = false;
      for (std::int32_t z = first; z <= last; ++z) {
        const bool is_open = !box.at({x, y, z});
        if (is_open && !in_run) open.push_back({x, y, z});
        in_run = is_open;
      }
    }
  }
}

}  // namespace

Result<BrickMasks> not_reached_from_outside(const BrickMasks& surface) {
  const auto bounds = bounds_of(surface);
  if (!bounds) return BrickMasks{};
  auto [low, high] = *bounds;
  // One more on every side, so that what is outside hangs together.
  low = {low.x - 1, low.y - 1, low.z - 1};
  high = {high.x + 1, high.y + 1, high.z + 1};
  const auto edge = [](std::int32_t a, std::int32_t b) { return std::int64_t{b} - a + 1; };
  // Three edges of at most 2^16 each.
  if (edge(low.x, high.x) * edge(low.y, high.y) * edge(low.z, high.z) > kMaxFloodedVoxels) {
    return refuse(Code::kTooLarge,
                  "the model is not watertight, and too large to find its inside; close it, or take its surface only");
  }
  BitBox box(low, high);
  for (const VoxelIndex v : surface.voxels()) box.set(box.local(v));
  flood(box);
  BrickMasks inside;
  const VoxelIndex size = box.size();
  for (std::int32_t x = 0; x < size.x; ++x) {
    for (std::int32_t y = 0; y < size.y; ++y) {
      for (std::int32_t z = 0; z < size.z; ++z) {
        if (!box.at({x, y, z})) inside.insert(VoxelIndex{low.x + x, low.y + y, low.z + z});
      }
    }
  }
  return inside;
}

}  // namespace concord
