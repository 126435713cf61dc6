#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/lattice.hpp"

namespace concord {

/// voxel_of by a product and without a call: what the inner loops can afford. @pre |p| * per_metre < 2^31.
[[nodiscard]] inline VoxelIndex cell_of(const Eigen::Vector3d& p, double per_metre) {
  const auto down = [](double v) {
    const auto cut = static_cast<std::int32_t>(v);
    return cut - static_cast<std::int32_t>(v < cut);
  };
  return {down(p.x() * per_metre), down(p.y() * per_metre), down(p.z() * per_metre)};
}

/// Numbers the cells of a lattice in the order in which they are first named. Kept in blocks of 4 x 4 x 4, so that
/// looking around a cell touches few of them; 256 bytes a block.
class CellTable {
 public:
  /// The number of a cell, or -1.
  [[nodiscard]] int find(VoxelIndex cell) const {
    const Block* block = find_block(block_of(cell));
    return block != nullptr ? (*block)[local(cell)] : -1;
  }
  /// The number of a cell; a new one gets the next number.
  int insert(VoxelIndex cell) {
    const VoxelIndex index = block_of(cell);
    if (last_ < 0 || !(block_index_[last_] == index)) last_ = insert_block(index);
    std::int32_t& number = blocks_[last_][local(cell)];
    if (number < 0) {
      number = static_cast<std::int32_t>(cells_.size());
      cells_.push_back(cell);
    }
    return number;
  }
  [[nodiscard]] const std::vector<VoxelIndex>& cells() const { return cells_; }

  /// Finds cells near each other: remembers the block that it looked into last.
  class Cursor {
   public:
    explicit Cursor(const CellTable& table) : table_(table) {}
    [[nodiscard]] int find(VoxelIndex cell) {
      const VoxelIndex index = block_of(cell);
      if (!is_set_ || !(index == index_)) {
        block_ = table_.find_block(index);
        index_ = index;
        is_set_ = true;
      }
      return block_ != nullptr ? (*block_)[local(cell)] : -1;
    }

   private:
    const CellTable& table_;
    const std::array<std::int32_t, 64>* block_ = nullptr;
    VoxelIndex index_;
    bool is_set_ = false;
  };

 private:
  using Block = std::array<std::int32_t, 64>;
  struct Slot {
    VoxelIndex index;
    std::int32_t block = -1;
  };

  [[nodiscard]] static VoxelIndex block_of(VoxelIndex c) { return {c.x >> 2, c.y >> 2, c.z >> 2}; }
  [[nodiscard]] static int local(VoxelIndex c) { return (c.x & 3) | (c.y & 3) << 2 | (c.z & 3) << 4; }
  [[nodiscard]] static std::size_t hash(VoxelIndex c) {
    const auto u = [](std::int32_t v) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v)); };
    std::uint64_t h = u(c.x) * 0x9E3779B97F4A7C15ULL + u(c.y) * 0xC2B2AE3D27D4EB4FULL + u(c.z) * 0x165667B19E3779F9ULL;
    return h ^ (h >> 32);
  }
  /// Where a block is, or where it would be put.
  [[nodiscard]] std::size_t slot_of(VoxelIndex index) const {
    std::size_t slot = hash(index) & mask_;
    while (slots_[slot].block >= 0 && !(slots_[slot].index == index)) slot = (slot + 1) & mask_;
    return slot;
  }
  [[nodiscard]] const Block* find_block(VoxelIndex index) const {
    const std::int32_t block = slots_[slot_of(index)].block;
    return block >= 0 ? &blocks_[block] : nullptr;
  }
  std::int32_t insert_block(VoxelIndex index) {
    std::size_t slot = slot_of(index);
    if (slots_[slot].block >= 0) return slots_[slot].block;
    if (3 * (blocks_.size() + 1) > slots_.size()) {
      grow();
      slot = slot_of(index);
    }
    slots_[slot] = {index, static_cast<std::int32_t>(blocks_.size())};
    blocks_.emplace_back().fill(-1);
    block_index_.push_back(index);
    return slots_[slot].block;
  }
  void grow() {
    slots_.assign(slots_.size() * 2, Slot{});
    mask_ = slots_.size() - 1;
    for (std::size_t i = 0; i < block_index_.size(); ++i) {
      slots_[slot_of(block_index_[i])] = {block_index_[i], static_cast<std::int32_t>(i)};
    }
  }

  std::vector<Slot> slots_ = std::vector<Slot>(256);
  std::size_t mask_ = 255;
  std::vector<Block> blocks_;
  std::vector<VoxelIndex> block_index_;
  std::vector<VoxelIndex> cells_;
  std::int32_t last_ = -1;
};

}  // namespace concord
