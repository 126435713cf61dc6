#include "core/brick_kernels_avx2.hpp"

#if defined(__x86_64__)

#include <algorithm>
#include <bit>
#include <cstring>

#include <immintrin.h>

#define CONCORD_AVX2 __attribute__((target("avx2,popcnt,bmi")))

namespace concord {
namespace {

// Byte shuffles for a row of 8 keys, by the row's mask: packed values to their places and back; 0x80 makes a zero.
struct RowShuffles {
  alignas(16) std::array<std::array<std::uint8_t, 16>, 256> spread{};
  alignas(16) std::array<std::array<std::uint8_t, 16>, 256> gather{};
};

constexpr RowShuffles kShuffles = [] {
  RowShuffles shuffles;
  for (int mask = 0; mask < 256; ++mask) {
    shuffles.spread[mask].fill(0x80);
    shuffles.gather[mask].fill(0x80);
    int rank = 0;
    for (int x = 0; x < 8; ++x) {
      if ((mask >> x & 1) == 0) continue;
      for (int byte = 0; byte < 2; ++byte) {
        shuffles.spread[mask][2 * x + byte] = static_cast<std::uint8_t>(2 * rank + byte);
        shuffles.gather[mask][2 * rank + byte] = static_cast<std::uint8_t>(2 * x + byte);
      }
      ++rank;
    }
  }
  return shuffles;
}();

CONCORD_AVX2 inline __m128i load(const void* from) { return _mm_loadu_si128(static_cast<const __m128i*>(from)); }
CONCORD_AVX2 inline __m256i load256(const void* from) { return _mm256_loadu_si256(static_cast<const __m256i*>(from)); }
CONCORD_AVX2 inline void store256(void* to, __m256i value) { _mm256_storeu_si256(static_cast<__m256i*>(to), value); }
CONCORD_AVX2 inline void store(void* to, __m128i value) { _mm_storeu_si128(static_cast<__m128i*>(to), value); }

CONCORD_AVX2 int count(const VoxelMask& mask) {
  int sum = 0;
  for (const std::uint64_t word : mask) sum += std::popcount(word);
  return sum;
}

CONCORD_AVX2 void expand_uniform(const VoxelMask& known, LogOdds value, Key* cells, int row, int plane) {
  const __m128i bit = _mm_setr_epi16(1, 2, 4, 8, 16, 32, 64, 128);
  const __m128i key = _mm_set1_epi16(static_cast<short>(key_of(value)));
  for (int z = 0; z < kBrickSide; ++z) {
    std::uint64_t bits = known[z];
    for (int y = 0; y < kBrickSide; ++y, bits >>= 8) {
      const __m128i mask = _mm_and_si128(_mm_set1_epi16(static_cast<short>(bits & 0xFF)), bit);
      store(cells + z * plane + y * row, _mm_and_si128(_mm_cmpeq_epi16(mask, bit), key));
    }
  }
}

CONCORD_AVX2 VoxelMask expand(const VoxelMask& known, const LogOdds* values, bool uniform, Key* cells, int row,
                              int plane) {
  if (uniform) {
    expand_uniform(known, *values, cells, row, plane);
    return is_occupied(*values) ? known : VoxelMask{};
  }
  // Rows read 8 values at once; the last ones from a copy, so that nothing past the end is read.
  const int size = count(known);
  const int tail_start = size > 8 ? size - 8 : 0;
  LogOdds tail[16] = {};
  std::copy_n(values + tail_start, size - tail_start, tail);
  const __m128i bias = _mm_set1_epi16(static_cast<short>(0x8000));
  VoxelMask occupied;
  int rank = 0;
  for (int z = 0; z < kBrickSide; ++z) {
    std::uint64_t bits = known[z];
    std::uint64_t signs = 0;
    for (int y = 0; y < kBrickSide; ++y, bits >>= 8) {
      const unsigned mask = bits & 0xFF;
      const LogOdds* from = rank + 8 <= size ? values + rank : tail + (rank - tail_start);
      const __m128i keys = _mm_xor_si128(load(from), bias);
      const __m128i cell_keys = _mm_shuffle_epi8(keys, load(kShuffles.spread[mask].data()));
      store(cells + z * plane + y * row, cell_keys);
      const unsigned sign = _mm_movemask_epi8(_mm_packs_epi16(cell_keys, _mm_setzero_si128()));
      signs |= std::uint64_t{sign} << (8 * y);
      rank += std::popcount(mask);
    }
    occupied[z] = signs;
  }
  return occupied;
}

CONCORD_AVX2 int pack(const Key* brick, VoxelMask& known, LogOdds* packed) {
  const __m128i bias = _mm_set1_epi16(static_cast<short>(0x8000));
  const __m128i zero = _mm_setzero_si128();
  int size = 0;
  for (int z = 0; z < kBrickSide; ++z) {
    std::uint64_t bits = 0;
    for (int y = 0; y < kBrickSide; ++y) {
      const __m128i keys = load(brick + z * 64 + y * 8);
      const __m128i unknown = _mm_cmpeq_epi16(keys, zero);
      const unsigned mask = ~_mm_movemask_epi8(_mm_packs_epi16(unknown, zero)) & 0xFF;
      store(packed + size, _mm_shuffle_epi8(_mm_xor_si128(keys, bias), load(kShuffles.gather[mask].data())));
      size += std::popcount(mask);
      bits |= std::uint64_t{mask} << (8 * y);
    }
    known[z] = bits;
  }
  return size;
}

// Of the 64 blocks of 2 x 2 x 2 voxels, those whose middle is at or beside a known source voxel.
CONCORD_AVX2 std::uint64_t active_blocks(const std::uint64_t* near, const PullSteps& steps, const FixedPoint& origin) {
  const __m256i x0 = _mm256_set1_epi32(origin[0] + steps.half[0]);
  const __m256i y0 = _mm256_set1_epi32(origin[1] + steps.half[1]);
  const __m256i z0 = _mm256_set1_epi32(origin[2] + steps.half[2]);
  const __m256i rows = _mm256_set1_epi32(SourceBox::kNearRow << 16 | 1);
  const __m256i first = _mm256_set1_epi32(SourceBox::near_row(0, 0));
  std::uint64_t active = 0;
  for (int block = 0; block < 64; block += 8) {
    const __m256i x = _mm256_srli_epi32(_mm256_add_epi32(x0, load256(&steps.block[0][block])), kFractionBits);
    const __m256i y = _mm256_srli_epi32(_mm256_add_epi32(y0, load256(&steps.block[1][block])), kFractionBits);
    const __m256i z = _mm256_srli_epi32(_mm256_add_epi32(z0, load256(&steps.block[2][block])), kFractionBits - 16);
    const __m256i row = _mm256_add_epi32(_mm256_madd_epi16(_mm256_blend_epi16(y, z, 0xAA), rows), first);
    const __m256i half = _mm256_add_epi32(_mm256_slli_epi32(row, 1), _mm256_srli_epi32(x, 5));
    const __m256i bits = _mm256_i32gather_epi32(reinterpret_cast<const int*>(near), half, 4);
    // The wanted bit becomes the sign.
    const __m256i shift = _mm256_andnot_si256(x, _mm256_set1_epi32(31));
    const __m256i sign = _mm256_sllv_epi32(bits, shift);
    active |= static_cast<std::uint64_t>(_mm256_movemask_ps(_mm256_castsi256_ps(sign))) << block;
  }
  return active;
}

inline void put_pair(Key* to, std::int64_t pair) {
  const auto two = static_cast<std::uint32_t>(pair);
  std::memcpy(to, &two, sizeof(two));
}

CONCORD_AVX2 bool pull(const Key* cells, const std::uint64_t* near, const PullSteps& steps, const FixedPoint& origin,
                       Key* out) {
  std::uint64_t active = active_blocks(near, steps, origin);
  if (active == 0) return false;
  if (active != ~std::uint64_t{0}) std::memset(out, 0, kBrickVoxels * sizeof(Key));
  const __m256i x0 = _mm256_add_epi32(_mm256_set1_epi32(origin[0]), load256(steps.lane[0].data()));
  const __m256i y0 = _mm256_add_epi32(_mm256_set1_epi32(origin[1]), load256(steps.lane[1].data()));
  const __m256i z0 = _mm256_add_epi32(_mm256_set1_epi32(origin[2]), load256(steps.lane[2].data()));
  const __m256i strides = _mm256_set1_epi32(SourceBox::kPlane << 16 | SourceBox::kRow);
  const __m256i low_halves = _mm256_setr_epi8(0, 1, 4, 5, 8, 9, 12, 13, -1, -1, -1, -1, -1, -1, -1, -1,  //
                                              0, 1, 4, 5, 8, 9, 12, 13, -1, -1, -1, -1, -1, -1, -1, -1);
  for (; active != 0; active &= active - 1) {
    const int block = std::countr_zero(active);
    const __m256i x = _mm256_add_epi32(x0, _mm256_set1_epi32(steps.block[0][block]));
    const __m256i y = _mm256_add_epi32(y0, _mm256_set1_epi32(steps.block[1][block]));
    const __m256i z = _mm256_add_epi32(z0, _mm256_set1_epi32(steps.block[2][block]));
    // 16-bit halves (y, z) times (row, plane), added in one instruction.
    const __m256i yz = _mm256_blend_epi16(_mm256_srli_epi32(y, kFractionBits),  //
                                          _mm256_srli_epi32(z, kFractionBits - 16), 0xAA);
    const __m256i cell = _mm256_add_epi32(_mm256_madd_epi16(yz, strides), _mm256_srli_epi32(x, kFractionBits));
    const __m256i found = _mm256_i32gather_epi32(reinterpret_cast<const int*>(cells), cell, 2);
    const __m256i keys = _mm256_shuffle_epi8(found, low_halves);
    const std::int64_t lower = _mm256_extract_epi64(keys, 0);  // z of the block's first voxel
    const std::int64_t upper = _mm256_extract_epi64(keys, 2);
    Key* corner = out + (block & 3) * 2 + (block >> 2 & 3) * 16 + (block >> 4) * 128;
    put_pair(corner, lower);
    put_pair(corner + 8, lower >> 32);
    put_pair(corner + 64, upper);
    put_pair(corner + 72, upper >> 32);
  }
  return true;
}

CONCORD_AVX2 inline __m256i wide(const std::uint64_t* row) {
  const __m256i bits = load256(row);
  return _mm256_or_si256(bits, _mm256_or_si256(_mm256_slli_epi64(bits, 1), _mm256_srli_epi64(bits, 1)));
}

CONCORD_AVX2 void widen(const std::uint64_t* known, std::uint64_t* near, int first, int last) {
  for (int z = first; z < last; ++z) {
    for (int y = 0; y < SourceBox::kSide; y += 4) {
      const std::uint64_t* row = known + SourceBox::near_row(y, z);
      const __m256i bits = _mm256_or_si256(wide(row), _mm256_or_si256(wide(row - 1), wide(row + 1)));
      for (int plane = z - 1; plane <= z + 1; ++plane) {
        std::uint64_t* out = near + SourceBox::near_row(y, plane);
        store256(out, _mm256_or_si256(load256(out), bits));
      }
    }
  }
}

/// What layers say about 16 voxels, as far as both policies need it.
struct Claims {
  __m256i unknown, occupied, free;
};

CONCORD_AVX2 inline Claims no_claims() {
  return {_mm256_set1_epi16(-1), _mm256_setzero_si256(), _mm256_setzero_si256()};
}

/// @return which of the voxels the layer does not know.
CONCORD_AVX2 inline __m256i add(Claims& claims, __m256i keys, __m256i log_odds) {
  const __m256i unknown = _mm256_cmpeq_epi16(keys, _mm256_setzero_si256());
  const __m256i occupied = _mm256_cmpgt_epi16(log_odds, _mm256_set1_epi16(kConflictOccupied - 1));
  const __m256i free = _mm256_cmpgt_epi16(_mm256_set1_epi16(kConflictFree + 1), log_odds);
  claims.unknown = _mm256_and_si256(claims.unknown, unknown);
  claims.occupied = _mm256_or_si256(claims.occupied, occupied);
  claims.free = _mm256_or_si256(claims.free, _mm256_andnot_si256(unknown, free));
  return unknown;
}

CONCORD_AVX2 inline void put_conflicts(const Claims& claims, int first, VoxelMask& conflicts) {
  const __m256i both = _mm256_and_si256(claims.occupied, claims.free);
  const __m128i bytes = _mm_packs_epi16(_mm256_castsi256_si128(both), _mm256_extracti128_si256(both, 1));
  conflicts[first / 64] |= static_cast<std::uint64_t>(static_cast<unsigned>(_mm_movemask_epi8(bytes))) << (first % 64);
}

/// sum / weight rounded half away from zero; a sum below zero stays below zero. The quotient of floats is at most one
/// off, and the remainder tells. @pre 2 |sum| + weight < 2^31.
CONCORD_AVX2 inline __m256i rounded_mean(__m256i sum, __m256i weight) {
  const __m256i divisor = _mm256_max_epi32(weight, _mm256_set1_epi32(1));
  const __m256i twice = _mm256_add_epi32(divisor, divisor);
  const __m256i magnitude = _mm256_abs_epi32(sum);
  const __m256i dividend = _mm256_add_epi32(_mm256_add_epi32(magnitude, magnitude), divisor);
  const __m256i guess = _mm256_cvttps_epi32(_mm256_div_ps(_mm256_cvtepi32_ps(dividend), _mm256_cvtepi32_ps(twice)));
  const __m256i rest = _mm256_sub_epi32(dividend, _mm256_mullo_epi32(guess, twice));
  const __m256i too_small = _mm256_cmpgt_epi32(rest, _mm256_sub_epi32(twice, _mm256_set1_epi32(1)));
  const __m256i too_large = _mm256_srai_epi32(rest, 31);
  const __m256i rounded = _mm256_add_epi32(_mm256_sub_epi32(guess, too_small), too_large);
  const __m256i below_zero = _mm256_srai_epi32(sum, 31);
  const __m256i lost_sign = _mm256_and_si256(below_zero, _mm256_cmpeq_epi32(rounded, _mm256_setzero_si256()));
  return _mm256_add_epi32(_mm256_sign_epi32(rounded, _mm256_or_si256(below_zero, _mm256_set1_epi32(1))), lost_sign);
}

/// Two layers at a time: their values side by side, so that one instruction multiplies and adds both.
CONCORD_AVX2 void mean(const Key* const* bricks, const std::int32_t* weights, int layers, Key* out,
                       VoxelMask& conflicts) {
  constexpr int kMaxTotal = 32767;
  int total = 0;
  for (int layer = 0; layer < layers && total <= kMaxTotal; ++layer) total += weights[layer];
  if (total > kMaxTotal) return portable_kernels().mean(bricks, weights, layers, out, conflicts);
  const __m256i bias = _mm256_set1_epi16(static_cast<short>(0x8000));
  conflicts = {};
  for (int first = 0; first < kBrickVoxels; first += 16) {
    Claims claims = no_claims();
    __m256i sum_low = _mm256_setzero_si256();
    __m256i sum_high = sum_low;
    __m256i weight_low = sum_low;
    __m256i weight_high = sum_low;
    for (int layer = 0; layer < layers; layer += 2) {
      const bool has_second = layer + 1 < layers;
      const __m256i a = load256(bricks[layer] + first);
      const __m256i b = has_second ? load256(bricks[layer + 1] + first) : _mm256_setzero_si256();
      const __m256i pair = _mm256_set1_epi32((has_second ? weights[layer + 1] : 0) << 16 | weights[layer]);
      const __m256i a_raw = _mm256_xor_si256(a, bias);
      const __m256i b_raw = _mm256_xor_si256(b, bias);
      const __m256i a_unknown = add(claims, a, a_raw);
      const __m256i b_unknown = add(claims, b, b_raw);
      const __m256i a_value = _mm256_andnot_si256(a_unknown, a_raw);
      const __m256i b_value = _mm256_andnot_si256(b_unknown, b_raw);
      sum_low = _mm256_add_epi32(sum_low, _mm256_madd_epi16(_mm256_unpacklo_epi16(a_value, b_value), pair));
      sum_high = _mm256_add_epi32(sum_high, _mm256_madd_epi16(_mm256_unpackhi_epi16(a_value, b_value), pair));
      // A mask is -1 where it is set: what is unknown takes its weight away again.
      const __m256i both = _mm256_set1_epi32(weights[layer] + (has_second ? weights[layer + 1] : 0));
      const __m256i missing_low = _mm256_madd_epi16(_mm256_unpacklo_epi16(a_unknown, b_unknown), pair);
      const __m256i missing_high = _mm256_madd_epi16(_mm256_unpackhi_epi16(a_unknown, b_unknown), pair);
      weight_low = _mm256_add_epi32(weight_low, _mm256_add_epi32(both, missing_low));
      weight_high = _mm256_add_epi32(weight_high, _mm256_add_epi32(both, missing_high));
    }
    const __m256i mean = _mm256_packs_epi32(rounded_mean(sum_low, weight_low), rounded_mean(sum_high, weight_high));
    store256(out + first, _mm256_andnot_si256(claims.unknown, _mm256_xor_si256(mean, bias)));
    put_conflicts(claims, first, conflicts);
  }
}

CONCORD_AVX2 void table(const Key* const* bricks, int layers, Key* out, VoxelMask& conflicts) {
  const __m256i bias = _mm256_set1_epi16(static_cast<short>(0x8000));
  conflicts = {};
  for (int first = 0; first < kBrickVoxels; first += 16) {
    Claims claims = no_claims();
    __m256i largest = _mm256_setzero_si256();
    for (int layer = 0; layer < layers; ++layer) {
      const __m256i keys = load256(bricks[layer] + first);
      add(claims, keys, _mm256_xor_si256(keys, bias));
      largest = _mm256_max_epu16(largest, keys);
    }
    store256(out + first, largest);
    put_conflicts(claims, first, conflicts);
  }
}

constexpr BrickKernels kKernels{count, expand, pack, widen, pull, mean, table};

}  // namespace

const BrickKernels* avx2_kernels() {
  const bool can = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt") && __builtin_cpu_supports("bmi");
  return can ? &kKernels : nullptr;
}

}  // namespace concord

#else

namespace concord {

const BrickKernels* avx2_kernels() { return nullptr; }

}  // namespace concord

#endif
