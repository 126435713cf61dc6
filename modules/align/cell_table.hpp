#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/lattice.hpp"

namespace concord {

/// Numbers the cells of a lattice in the order in which they are first named. Indices within +-2^20.
class CellTable {
 public:
  static constexpr std::int32_t kReach = 1 << 20;

  /// The number of a cell, or -1.
  [[nodiscard]] int find(VoxelIndex cell) const {
    for (std::size_t slot = hash(cell) & mask_;; slot = (slot + 1) & mask_) {
      const Slot& s = slots_[slot];
      if (s.number < 0) return -1;
      if (s.cell == cell) return s.number;
    }
  }
  /// The number of a cell; a new one gets the next number.
  int insert(VoxelIndex cell) {
    if (2 * (cells_.size() + 1) > slots_.size()) grow();
    std::size_t slot = hash(cell) & mask_;
    for (; slots_[slot].number >= 0; slot = (slot + 1) & mask_) {
      if (slots_[slot].cell == cell) return slots_[slot].number;
    }
    slots_[slot] = {cell, static_cast<std::int32_t>(cells_.size())};
    cells_.push_back(cell);
    return slots_[slot].number;
  }
  [[nodiscard]] const std::vector<VoxelIndex>& cells() const { return cells_; }

 private:
  struct Slot {
    VoxelIndex cell;
    std::int32_t number = -1;
  };
  [[nodiscard]] static std::size_t hash(VoxelIndex c) {
    const auto u = [](std::int32_t v) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v)); };
    std::uint64_t h = u(c.x) * 0x9E3779B97F4A7C15ULL + u(c.y) * 0xC2B2AE3D27D4EB4FULL + u(c.z) * 0x165667B19E3779F9ULL;
    return h ^ (h >> 32);
  }
  void grow() {
    slots_.assign(slots_.size() * 2, Slot{});
    mask_ = slots_.size() - 1;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      std::size_t slot = hash(cells_[i]) & mask_;
      while (slots_[slot].number >= 0) slot = (slot + 1) & mask_;
      slots_[slot] = {cells_[i], static_cast<std::int32_t>(i)};
    }
  }

  std::vector<Slot> slots_ = std::vector<Slot>(1024);
  std::size_t mask_ = 1023;
  std::vector<VoxelIndex> cells_;
};

}  // namespace concord
