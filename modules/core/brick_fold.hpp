#pragma once

#include <cstdint>
#include <cstdlib>

#include "core/brick_kernels.hpp"

namespace concord::fold_loops {

// Written for the compiler's vectoriser and inlined into each kernel, which says what machine it may assume.
#define CONCORD_INLINE [[gnu::always_inline]] inline

inline constexpr int kChunk = 32;  // voxels whose sums stay in registers or the first cache lines of the stack

/// Which voxels some layer holds for occupied and another for free.
struct Claims {
  Key occupied[kChunk] = {};
  Key free[kChunk] = {};

  CONCORD_INLINE void add(const Key* keys) {
    for (int i = 0; i < kChunk; ++i) {
      occupied[i] |= static_cast<Key>(-(keys[i] >= key_of(kConflictOccupied)));
      free[i] |= static_cast<Key>(-((keys[i] != 0) & (keys[i] <= key_of(kConflictFree))));
    }
  }
  CONCORD_INLINE std::uint32_t conflicts() const {
    Key any = 0;
    for (int i = 0; i < kChunk; ++i) any |= occupied[i] & free[i];
    if (any == 0) return 0;
    std::uint32_t mask = 0;
    for (int i = 0; i < kChunk; ++i) mask |= static_cast<std::uint32_t>((occupied[i] & free[i]) != 0) << i;
    return mask;
  }
};

CONCORD_INLINE void put(VoxelMask& mask, int first, std::uint32_t bits) {
  mask[first / 64] |= static_cast<std::uint64_t>(bits) << (first % 64);
}

/// sum / weight rounded half away from zero; below zero stays below zero. Exact: a double holds both, and a quotient
/// that is no tie is further from one than a double's precision.
template <class Sum>
CONCORD_INLINE Key mean_key(Sum sum, Sum weight) {
  const double magnitude = static_cast<double>(sum < 0 ? -sum : sum);
  const double divisor = static_cast<double>(weight == 0 ? 1 : weight);
  const auto rounded = static_cast<std::int32_t>(magnitude / divisor + 0.5);
  const std::int32_t negative = rounded == 0 ? -1 : -rounded;
  const std::int32_t mean = sum < 0 ? negative : rounded;
  return weight == 0 ? Key{0} : static_cast<Key>(mean + 32768);
}

template <class Sum>
CONCORD_INLINE void mean(const Key* const* bricks, const std::int32_t* weights, int count, Key* out,
                         VoxelMask& conflicts) {
  conflicts = {};
  for (int first = 0; first < kBrickVoxels; first += kChunk) {
    Sum sum[kChunk] = {};
    Sum weight[kChunk] = {};
    Claims claims;
    for (int layer = 0; layer < count; ++layer) {
      const Key* keys = bricks[layer] + first;
      const Sum w = weights[layer];
      for (int i = 0; i < kChunk; ++i) {
        const Sum known = keys[i] != 0 ? w : 0;
        sum[i] += known * (static_cast<Sum>(keys[i]) - 32768);
        weight[i] += known;
      }
      claims.add(keys);
    }
    for (int i = 0; i < kChunk; ++i) out[first + i] = mean_key(sum[i], weight[i]);
    put(conflicts, first, claims.conflicts());
  }
}

/// 32 bits suffice for the sums of values of up to 16 bits whose weights add up to less than 2^16.
CONCORD_INLINE void mean_of(const Key* const* bricks, const std::int32_t* weights, int count, Key* out,
                            VoxelMask& conflicts) {
  std::int64_t total = 0;
  for (int layer = 0; layer < count; ++layer) total += weights[layer];
  if (total < 65536) {
    mean<std::int32_t>(bricks, weights, count, out, conflicts);
  } else {
    mean<std::int64_t>(bricks, weights, count, out, conflicts);
  }
}

CONCORD_INLINE void table_of(const Key* const* bricks, int count, Key* out, VoxelMask& conflicts) {
  conflicts = {};
  for (int first = 0; first < kBrickVoxels; first += kChunk) {
    Key largest[kChunk] = {};
    Claims claims;
    for (int layer = 0; layer < count; ++layer) {
      const Key* keys = bricks[layer] + first;
      for (int i = 0; i < kChunk; ++i) largest[i] = keys[i] > largest[i] ? keys[i] : largest[i];
      claims.add(keys);
    }
    for (int i = 0; i < kChunk; ++i) out[first + i] = largest[i];
    put(conflicts, first, claims.conflicts());
  }
}

CONCORD_INLINE void widen_planes(const std::uint64_t* known, std::uint64_t* near, int first, int last) {
  for (int z = first; z < last; ++z) {
    const std::uint64_t* row = known + SourceBox::near_row(0, z);
    std::uint64_t wide[SourceBox::kSide + 2];
    for (int y = 0; y < SourceBox::kSide + 2; ++y) wide[y] = row[y - 1] | row[y - 1] << 1 | row[y - 1] >> 1;
    for (int plane = z - 1; plane <= z + 1; ++plane) {
      std::uint64_t* out = near + SourceBox::near_row(0, plane);
      for (int y = 0; y < SourceBox::kSide; ++y) out[y] |= wide[y] | wide[y + 1] | wide[y + 2];
    }
  }
}

#undef CONCORD_INLINE

}  // namespace concord::fold_loops
