#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace concord {

/// Whole numbers of 128 bits: products of three snapped coordinates fit.
__extension__ using Int128 = __int128;

/// Divisions that round down and up. @pre divisor > 0.
template <class Int>
[[nodiscard]] constexpr Int floor_div(Int a, Int divisor) {
  return a / divisor - (a % divisor < 0 ? 1 : 0);
}
template <class Int>
[[nodiscard]] constexpr Int ceil_div(Int a, Int divisor) {
  return a / divisor + (a % divisor > 0 ? 1 : 0);
}

/// Whole numbers from `first` to `last`, both included; none when last < first.
struct IntRange {
  std::int64_t first = std::numeric_limits<std::int64_t>::min() / 4;
  std::int64_t last = std::numeric_limits<std::int64_t>::max() / 4;

  [[nodiscard]] bool empty() const { return last < first; }
  [[nodiscard]] IntRange operator&(const IntRange& other) const {
    return {std::max(first, other.first), std::min(last, other.last)};
  }
};

/// The k with low <= base + step k <= high.
template <class Int>
[[nodiscard]] constexpr IntRange solve(Int low, Int high, Int base, Int step) {
  low -= base;
  high -= base;
  if (low > high) return {0, -1};
  if (step == 0) return low <= 0 && 0 <= high ? IntRange{} : IntRange{0, -1};
  const Int first = step > 0 ? ceil_div<Int>(low, step) : ceil_div<Int>(-high, -step);
  const Int last = step > 0 ? floor_div<Int>(high, step) : floor_div<Int>(-low, -step);
  const IntRange all;
  return {static_cast<std::int64_t>(std::max<Int>(first, all.first)),
          static_cast<std::int64_t>(std::min<Int>(last, all.last))};
}

}  // namespace concord
