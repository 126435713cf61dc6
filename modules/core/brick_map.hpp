#pragma once

#include <bit>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/brick.hpp"

namespace concord {

/// Up to 64 bricks that lie together; `bricks` is in order of their position in the tile.
struct Tile {
  std::uint64_t present = 0;  ///< bit local_of(brick)
  std::vector<Brick> bricks;

  [[nodiscard]] const Brick* find(int local) const {
    const std::uint64_t bit = std::uint64_t{1} << local;
    return (present & bit) != 0 ? &bricks[std::popcount(present & (bit - 1))] : nullptr;
  }
};

/// A sparse voxel map on one lattice: an agent's layer, the merged map, conflicts, a 2D grid (z = 0).
/// Holds no empty brick. The resolution belongs to whoever owns the map.
class BrickMap {
 public:
  [[nodiscard]] const Brick* find(BrickIndex index) const;
  [[nodiscard]] LogOdds at(VoxelIndex voxel) const;
  [[nodiscard]] const Tile* find(TileIndex index) const;

  /// Replaces a brick; an empty one is removed. Returns whether the content changed.
  bool set(BrickIndex index, Brick brick);
  /// Replaces a whole tile; one without bricks is removed. @pre one brick, not empty, for each bit of `tile.present`.
  void set(TileIndex index, Tile tile);
  void clear();

  [[nodiscard]] bool empty() const { return brick_count_ == 0; }
  [[nodiscard]] std::size_t brick_count() const { return brick_count_; }
  [[nodiscard]] std::size_t known_count() const { return known_count_; }
  /// Walks the whole map.
  [[nodiscard]] std::size_t occupied_count() const;

  /// In ascending order: what every output and digest walks.
  [[nodiscard]] std::vector<TileIndex> sorted_tiles() const;
  [[nodiscard]] std::vector<BrickIndex> sorted_bricks() const;

  /// Calls `visit(BrickIndex, const Brick&)` in no particular order.
  template <class Visit>
  void for_each_brick(Visit&& visit) const {
    for (const auto& [index, tile] : tiles_) {
      std::size_t next = 0;
      for (std::uint64_t bits = tile.present; bits != 0; bits &= bits - 1) {
        visit(brick_at(index, std::countr_zero(bits)), tile.bricks[next++]);
      }
    }
  }

  bool operator==(const BrickMap& other) const;

 private:
  std::unordered_map<TileIndex, Tile, IndexHash> tiles_;
  std::size_t brick_count_ = 0;
  std::size_t known_count_ = 0;
};

/// 64-bit hash over the sorted brick indices and their values, nothing else: equal maps on any machine,
/// built in any order, have equal digests.
[[nodiscard]] std::uint64_t digest(const BrickMap& map);

/// The share of one brick in content hashes; the digest of a set of bricks can be kept by adding these.
[[nodiscard]] std::uint64_t content_hash(BrickIndex index, const Brick& brick);

}  // namespace concord
