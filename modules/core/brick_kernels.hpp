#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/brick.hpp"

namespace concord {

/// A voxel as the inner loops see it: log-odds + 32768. Unknown is 0, so a larger key is a larger value, everything
/// known outranks unknown, and memory is cleared with zeros.
using Key = std::uint16_t;

[[nodiscard]] constexpr Key key_of(LogOdds l) { return static_cast<Key>(l ^ 0x8000); }
[[nodiscard]] constexpr LogOdds log_odds_of(Key key) { return static_cast<LogOdds>(key ^ 0x8000); }

using KeyBrick = std::array<Key, kBrickVoxels>;

/// Part of a layer laid out for look-up: 64 x 64 x 64 voxels, x fastest. Rows and planes are padded so that the cells
/// of a rotated brick spread over the cache's sets; the extra cells at the end let 32 bits be read at any cell.
struct SourceBox {
  static constexpr int kSide = 64;
  static constexpr int kRow = 72;
  static constexpr int kPlane = kRow * kSide;
  static constexpr int kCells = kPlane * kSide + 2;
  static constexpr int kNearRow = kSide + 2;  ///< one row and plane of padding on either side
  static constexpr int kNearRows = kNearRow * kNearRow;

  [[nodiscard]] static constexpr int near_row(int y, int z) { return (z + 1) * kNearRow + y + 1; }
};

/// Fixed point: 24 fractional bits.
inline constexpr int kFractionBits = 24;
using FixedPoint = std::array<std::int32_t, 3>;

/// Where a tile's voxels lie in the source, relative to its first voxel; the same for each brick of the tile.
struct PullSteps {
  std::array<std::array<std::int32_t, 64>, 3> block;  ///< [axis][2 x 2 x 2 voxels of a brick, x fastest]
  std::array<std::array<std::int32_t, 8>, 3> lane;    ///< [axis][voxel of such a block, x fastest]
  FixedPoint half;                                    ///< from a block's first voxel to its middle
};

/// The inner loops, once for any machine and once for AVX2; both give the same bits.
struct BrickKernels {
  int (*count)(const VoxelMask& mask);

  /// Writes a brick's keys as rows of 8, `row` and `plane` cells apart; unknown voxels become 0.
  /// `values`: as packed, or one value if `uniform`. Returns the occupied voxels.
  VoxelMask (*expand)(const VoxelMask& known, const LogOdds* values, bool uniform, Key* cells, int row, int plane);

  /// Packs the known keys of a brick. `packed` has room for kBrickVoxels + 8. Returns how many there are.
  int (*pack)(const Key* brick, VoxelMask& known, LogOdds* packed);

  /// Sets in `near` the bits of `known` and of all 26 voxels around each, for 64 x 64 rows; see `near_row`.
  /// Reads only the planes from `first` to before `last`, and adds to what is set. @pre the padding of `known` is 0.
  void (*widen)(const std::uint64_t* known, std::uint64_t* near, int first, int last);

  /// Looks up each voxel of a target brick, whose first voxel's centre is at `origin`, in the source box.
  /// `near` has a bit for each source voxel that is known or touches a known one, in rows of 64 (see `near_row`).
  /// Returns false, with `out` untouched, where that proves that nothing is there.
  bool (*pull)(const Key* cells, const std::uint64_t* near, const PullSteps& steps, const FixedPoint& origin, Key* out);

  /// Folds bricks of several layers into one. `conflicts` gets the voxels where layers contradict each other.
  void (*mean)(const Key* const* bricks, const std::int32_t* weights, int count, Key* out, VoxelMask& conflicts);
  void (*table)(const Key* const* bricks, int count, Key* out, VoxelMask& conflicts);
};

[[nodiscard]] const BrickKernels& portable_kernels();
/// For this machine.
[[nodiscard]] const BrickKernels& brick_kernels();

/// A brick's keys as rows of 8, `row` and `plane` cells apart. Returns the occupied voxels.
VoxelMask expand(const Brick& brick, Key* cells, int row = kBrickSide, int plane = kBrickSide * kBrickSide);
/// From kBrickVoxels keys.
[[nodiscard]] Brick pack(const Key* keys);

}  // namespace concord
