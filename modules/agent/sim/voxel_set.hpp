#pragma once

#include <unordered_map>

#include "core/brick_map.hpp"

namespace concord {

/// A set of voxels of one lattice.
class VoxelSet {
 public:
  void insert(VoxelIndex voxel);
  [[nodiscard]] bool contains(VoxelIndex voxel) const;
  /// Whether the voxel or one of its 26 neighbours is in the set.
  [[nodiscard]] bool contains_near(VoxelIndex voxel) const;
  [[nodiscard]] std::size_t size() const;

  /// Calls `visit(VoxelIndex)` in no particular order.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const auto& [brick, mask] : masks_) {
      for (int word = 0; word < 8; ++word) {
        for (std::uint64_t bits = mask[word]; bits != 0; bits &= bits - 1) {
          visit(voxel_at(brick, word * 64 + std::countr_zero(bits)));
        }
      }
    }
  }

  /// Every voxel of the set as `kOccupied`.
  [[nodiscard]] BrickMap to_map() const;

 private:
  std::unordered_map<BrickIndex, VoxelMask, IndexHash> masks_;
};

/// The occupied voxels of a map.
[[nodiscard]] VoxelSet occupied_voxels(const BrickMap& map);

}  // namespace concord
