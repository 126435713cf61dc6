#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/brick.hpp"

namespace concord {

/// What people pinned in one brick of the map. No voxel is in both masks.
struct PinBrick {
  VoxelMask occupied{};
  VoxelMask free{};
  bool operator==(const PinBrick&) const = default;
};

/// The pinned voxels of the map: what the active edits amount to, the latest one winning in its voxels.
class PinMap {
 public:
  enum class Pin { kNone, kAdded, kDeleted };

  /// Replaces what was pinned there; `kNone` takes the pin away.
  void set(VoxelIndex voxel, Pin pin);
  /// Replaces all pins of a brick. Returns whether they changed.
  bool set(BrickIndex index, const PinBrick& pins);
  [[nodiscard]] Pin at(VoxelIndex voxel) const;
  [[nodiscard]] const PinBrick* find(BrickIndex index) const;
  void clear() { bricks_.clear(); }

  [[nodiscard]] bool empty() const { return bricks_.empty(); }
  /// Bricks with at least one pin, in ascending order.
  [[nodiscard]] std::vector<BrickIndex> sorted_bricks() const;

  bool operator==(const PinMap&) const = default;

 private:
  std::unordered_map<BrickIndex, PinBrick, IndexHash> bricks_;
};

}  // namespace concord
