#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/brick_map.hpp"
#include "core/voxel_boxes.hpp"

namespace concord {

/// A set of voxels, kept by brick: what a model fills, what a person touched, what an object is.
class BrickMasks {
 public:
  BrickMasks() = default;
  BrickMasks(const BrickMasks& other) : bricks_(other.bricks_) {}
  BrickMasks& operator=(const BrickMasks& other);
  BrickMasks(BrickMasks&& other) noexcept
      : bricks_(std::exchange(other.bricks_, {})), last_(std::exchange(other.last_, nullptr)) {}
  BrickMasks& operator=(BrickMasks&& other) noexcept;
  ~BrickMasks() = default;

  void insert(VoxelIndex voxel) { word_of(voxel) |= bit_of(voxel); }
  /// Voxels (x, y, first) to (x, y, last), both included.
  void insert_column(std::int32_t x, std::int32_t y, std::int32_t first, std::int32_t last);
  void insert(BrickIndex index, const VoxelMask& voxels);
  void insert(const BrickMasks& other);
  void erase(const BrickMasks& other);

  [[nodiscard]] bool contains(VoxelIndex voxel) const;
  [[nodiscard]] const VoxelMask* find(BrickIndex index) const;
  [[nodiscard]] std::int64_t count() const;
  [[nodiscard]] std::size_t brick_count() const { return bricks_.size(); }
  [[nodiscard]] bool empty() const { return count() == 0; }

  /// In ascending order; no empty mask.
  [[nodiscard]] std::vector<std::pair<BrickIndex, VoxelMask>> sorted() const;
  /// In ascending order.
  [[nodiscard]] std::vector<VoxelIndex> voxels() const;
  /// Every voxel of the set with this value.
  [[nodiscard]] BrickMap to_map(LogOdds value) const;

 private:
  [[nodiscard]] static std::uint64_t bit_of(VoxelIndex voxel) { return std::uint64_t{1} << (local_of(voxel) % 64); }
  std::uint64_t& word_of(VoxelIndex voxel) { return brick(brick_of(voxel))[local_of(voxel) / 64]; }
  VoxelMask& brick(BrickIndex index) {
    // Neighbours in the order of insertion are neighbours in space; nodes of the map stay where they are.
    if (last_ == nullptr || last_->first != index) last_ = &*bricks_.try_emplace(index).first;
    return last_->second;
  }

  std::unordered_map<BrickIndex, VoxelMask, IndexHash> bricks_;
  std::pair<const BrickIndex, VoxelMask>* last_ = nullptr;
};

/// The box around the voxels of a set; nothing around none.
[[nodiscard]] std::optional<VoxelBox> bounds_of(const BrickMasks& voxels);
/// The occupied voxels of a map.
[[nodiscard]] BrickMasks occupied_of(const BrickMap& map);
/// Those of the bricks that a box meets: costs the box or the map, whichever is less.
[[nodiscard]] BrickMasks occupied_around(const BrickMap& map, const VoxelBox& box);
/// The voxels of a list, in any order.
[[nodiscard]] BrickMasks masks_of(const std::vector<VoxelIndex>& voxels);

}  // namespace concord
