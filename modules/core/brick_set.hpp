#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/lattice.hpp"

namespace concord {

/// A set of bricks, kept by tile: what is dirty, what was touched, what is missing.
class BrickSet {
 public:
  struct Entry {
    TileIndex tile;
    std::uint64_t bricks = 0;  ///< bit local_of(brick)
  };

  void insert(BrickIndex brick) { tiles_[tile_of(brick)] |= std::uint64_t{1} << local_of(brick); }
  /// @pre `bricks` is not 0.
  void insert(TileIndex tile, std::uint64_t bricks) { tiles_[tile] |= bricks; }
  /// All bricks from `low` to `high`, both included.
  void insert_box(BrickIndex low, BrickIndex high);
  void insert(const BrickSet& other);
  void clear() { tiles_.clear(); }

  [[nodiscard]] bool contains(BrickIndex brick) const;
  [[nodiscard]] bool empty() const { return tiles_.empty(); }
  [[nodiscard]] std::size_t size() const;
  /// In ascending order of tiles.
  [[nodiscard]] std::vector<Entry> sorted() const;

 private:
  std::unordered_map<TileIndex, std::uint64_t, IndexHash> tiles_;
};

/// The bricks of one tile whose position lies from `low` to `high` (each 0 to 3, both included) on every axis.
[[nodiscard]] std::uint64_t tile_box(const BrickIndex& low, const BrickIndex& high);

}  // namespace concord
