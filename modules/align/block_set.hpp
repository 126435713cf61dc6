#pragma once

#include <cstdint>
#include <vector>

#include "align/cell_table.hpp"

namespace concord {

/// A set of cells, 64 to a word.
class BlockSet {
 public:
  void insert(VoxelIndex b) {
    const auto brick = static_cast<std::size_t>(bricks_.insert(brick_of(b)));
    if (brick == words_.size()) words_.push_back(0);
    words_[brick] |= bit_of(b);
  }
  [[nodiscard]] bool contains(VoxelIndex b) const {
    const int brick = bricks_.find(brick_of(b));
    return brick >= 0 && (words_[brick] & bit_of(b)) != 0;
  }
  /// A brick of 4 x 4 x 4 cells at once, bit x + 4 y + 16 z. @pre not inserted before.
  void insert_brick(VoxelIndex brick, std::uint64_t cells) {
    bricks_.insert(brick);
    words_.push_back(cells);
  }
  [[nodiscard]] const std::vector<VoxelIndex>& bricks() const { return bricks_.cells(); }
  [[nodiscard]] const std::vector<std::uint64_t>& words() const { return words_; }

 private:
  [[nodiscard]] static VoxelIndex brick_of(VoxelIndex b) { return {b.x >> 2, b.y >> 2, b.z >> 2}; }
  [[nodiscard]] static std::uint64_t bit_of(VoxelIndex b) {
    return std::uint64_t{1} << ((b.x & 3) | (b.y & 3) << 2 | (b.z & 3) << 4);
  }

  CellTable bricks_;
  std::vector<std::uint64_t> words_;
};

}  // namespace concord
