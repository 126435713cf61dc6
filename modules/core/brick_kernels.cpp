#include "core/brick_kernels.hpp"

#include <bit>

#include "core/brick_fold.hpp"
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
  fold_loops::widen_planes(known, near, first, last);
}

void mean(const Key* const* bricks, const std::int32_t* weights, int layers, Key* out, VoxelMask& conflicts) {
  fold_loops::mean_of(bricks, weights, layers, out, conflicts);
}

void table(const Key* const* bricks, int layers, Key* out, VoxelMask& conflicts) {
  fold_loops::table_of(bricks, layers, out, conflicts);
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

}  // namespace concord
