#pragma once

#include <array>
#include <vector>

#include "core/brick_map.hpp"
#include "core/lattice_transform.hpp"

namespace concord {

/// What a layer says about one tile of the map: bricks of the layer itself where the transform moves whole bricks to
/// whole bricks, else bricks of keys.
struct LayerTile {
  std::uint64_t bricks = 0;  ///< which bricks below mean anything; one of keys may still be all unknown
  bool is_whole = false;
  std::array<const Brick*, kTileBricks> whole{};  ///< if `is_whole`
  std::vector<KeyBrick> keys;                     ///< else; kTileBricks of them
};

/// Brings a layer into the map, tile by tile: each map voxel gets the value of the layer's voxel that holds its
/// centre; then each occupied voxel of the layer raises the map voxel that holds its own centre. The first rule alone
/// would lose occupied voxels, the second alone would leave holes.
///
/// Keeps 0.7 MB of working memory, so use one for many tiles.
class TilePuller {
 public:
  TilePuller();

  /// @param wanted the bricks of `tile` to bring in, bit local_of(brick).
  void pull(const BrickMap& layer, const LatticeTransform& transform, TileIndex tile, std::uint64_t wanted,
            LayerTile& out);

 private:
  /// Bricks of the layer that may matter to the tile; the source box begins at `base`.
  struct Region {
    BrickIndex base, low, high;
  };
  struct Source {
    const Brick* brick;
    BrickIndex index;
    BrickIndex position;  ///< in the source box, 0 to 7 on each axis
    VoxelMask occupied;
  };

  static void take_whole(const BrickMap& layer, BrickIndex shift, TileIndex tile, std::uint64_t wanted, LayerTile& out);
  [[nodiscard]] static Region region_of(const LatticeTransform& transform, TileIndex tile, std::uint64_t wanted);
  std::uint64_t find_sources(const BrickMap& layer, const LatticeTransform& transform, TileIndex tile,
                             std::uint64_t wanted, const Region& region);
  void fill();
  void raise(const LatticeTransform& transform, TileIndex tile, std::uint64_t wanted, LayerTile& out) const;
  void clear();

  std::vector<Source> sources_;
  // A source box (see there), zero between calls.
  std::vector<Key> cells_;
  std::vector<std::uint64_t> known_;
  std::vector<std::uint64_t> near_;
  int low_plane_ = 0, high_plane_ = 0;  // planes of the box that hold sources, the last one excluded
};

}  // namespace concord
