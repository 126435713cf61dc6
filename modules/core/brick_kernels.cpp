#include "core/brick_kernels.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "core/brick_kernels_avx2.hpp"

namespace concord {
namespace {

int count(const VoxelMask& mask) {
  int sum = 0;
  for (const std::uint64_t word : mask) sum += std::popcount(word);
  return sum;
}

VoxelMask expand(const VoxelMask& known, const LogOdds* values, bool uniform, Key* cells, int row, int plane) {
  VoxelMask occupied{};
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      Key* out = cells + z * plane + y * row;
      for (int x = 0; x < kBrickSide; ++x) {
        const bool is_set = (known[z] >> (y * 8 + x) & 1) != 0;
        out[x] = is_set ? key_of(*values) : Key{0};
        occupied[z] |= std::uint64_t{is_set && is_occupied(*values)} << (y * 8 + x);
        values += is_set && !uniform;
      }
    }
  }
  return occupied;
}

int pack(const Key* brick, VoxelMask& known, LogOdds* packed) {
  int size = 0;
  for (int word = 0; word < 8; ++word) {
    std::uint64_t bits = 0;
    for (int i = 0; i < 64; ++i) {
      const Key key = brick[word * 64 + i];
      bits |= std::uint64_t{key != 0} << i;
      packed[size] = log_odds_of(key);
      size += key != 0;
    }
    known[word] = bits;
  }
  return size;
}

bool pull(const Key* cells, const std::uint64_t* near, const PullSteps& steps, const FixedPoint& origin, Key* out) {
  const auto cell = [&](int axis, int block, std::int32_t offset) {
    return (origin[axis] + steps.block[axis][block] + offset) >> kFractionBits;
  };
  std::uint64_t active = 0;
  for (int block = 0; block < 64; ++block) {
    const int row = SourceBox::near_row(cell(1, block, steps.half[1]), cell(2, block, steps.half[2]));
    active |= (near[row] >> cell(0, block, steps.half[0]) & 1) << block;
  }
  if (active == 0) return false;
  for (int block = 0; block < 64; ++block) {
    const bool is_active = (active >> block & 1) != 0;
    Key* corner = out + (block & 3) * 2 + (block >> 2 & 3) * 16 + (block >> 4) * 128;
    for (int lane = 0; lane < 8; ++lane) {
      Key& key = corner[(lane & 1) + (lane >> 1 & 1) * 8 + (lane >> 2) * 64];
      key = is_active
                ? cells[cell(0, block, steps.lane[0][lane]) + cell(1, block, steps.lane[1][lane]) * SourceBox::kRow +
                        cell(2, block, steps.lane[2][lane]) * SourceBox::kPlane]
                : Key{0};
    }
  }
  return true;
}

void widen(const std::uint64_t* known, std::uint64_t* near, int first, int last) {
  for (int z = first; z < last; ++z) {
    const std::uint64_t* row = known + SourceBox::near_row(0, z);
    std::array<std::uint64_t, SourceBox::kNearRow> wide;  // from row -1 on
    for (int y = 0; y < SourceBox::kNearRow; ++y) wide[y] = row[y - 1] | row[y - 1] << 1 | row[y - 1] >> 1;
    for (int plane = z - 1; plane <= z + 1; ++plane) {
      std::uint64_t* out = near + SourceBox::near_row(0, plane);
      for (int y = 0; y < SourceBox::kSide; ++y) out[y] |= wide[y] | wide[y + 1] | wide[y + 2];
    }
  }
}

/// What all layers say about one voxel.
struct Claims {
  std::int64_t sum = 0;
  std::int64_t weight = 0;
  Key largest = 0;
  bool occupied = false;
  bool free = false;

  void add(Key key, std::int32_t w) {
    if (key == 0) return;
    const LogOdds l = log_odds_of(key);
    sum += std::int64_t{w} * l;
    weight += w;
    largest = std::max(largest, key);
    occupied |= l >= kConflictOccupied;
    free |= l <= kConflictFree;
  }
  /// Rounded half away from zero; a sum below zero stays below zero.
  [[nodiscard]] Key mean() const {
    if (weight == 0) return 0;
    const std::int64_t rounded = (2 * std::abs(sum) + weight) / (2 * weight);
    const std::int64_t negative = rounded == 0 ? -1 : -rounded;
    return key_of(static_cast<LogOdds>(sum < 0 ? negative : rounded));
  }
};

void mean(const Key* const* bricks, const std::int32_t* weights, int layers, Key* out, VoxelMask& conflicts) {
  conflicts = {};
  for (int i = 0; i < kBrickVoxels; ++i) {
    Claims claims;
    for (int layer = 0; layer < layers; ++layer) claims.add(bricks[layer][i], weights[layer]);
    out[i] = claims.mean();
    conflicts[i / 64] |= std::uint64_t{claims.occupied && claims.free} << (i % 64);
  }
}

void table(const Key* const* bricks, int layers, Key* out, VoxelMask& conflicts) {
  conflicts = {};
  for (int i = 0; i < kBrickVoxels; ++i) {
    Claims claims;
    for (int layer = 0; layer < layers; ++layer) claims.add(bricks[layer][i], 1);
    out[i] = claims.largest;
    conflicts[i / 64] |= std::uint64_t{claims.occupied && claims.free} << (i % 64);
  }
}

}  // namespace

const BrickKernels& portable_kernels() {
  static constexpr BrickKernels kKernels{count, expand, pack, widen, pull, mean, table};
  return kKernels;
}

const BrickKernels& brick_kernels() {
  static const BrickKernels* const kKernels = [] {
    const BrickKernels* avx2 = avx2_kernels();
    return avx2 != nullptr ? avx2 : &portable_kernels();
  }();
  return *kKernels;
}

VoxelMask expand(const Brick& brick, Key* cells, int row, int plane) {
  const LogOdds uniform = brick.is_uniform() && !brick.empty() ? brick.uniform_value() : kUnknown;
  const LogOdds* values = brick.is_uniform() ? &uniform : brick.packed().data();
  return brick_kernels().expand(brick.known(), values, brick.is_uniform(), cells, row, plane);
}

Brick pack(const Key* keys) {
  VoxelMask known;
  std::array<LogOdds, kBrickVoxels + 8> packed;
  const int size = brick_kernels().pack(keys, known, packed.data());
  return Brick::from_packed(known, {packed.data(), static_cast<std::size_t>(size)});
}

}  // namespace concord
