#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace concord {

/// A bitmap as lines of 64-bit words, bit i of a line in word i / 64: what block-wise scans run over.
class BitLines {
 public:
  BitLines() = default;
  /// All bits are `fill`, those beyond `length` in a line's last word too.
  BitLines(int lines, int length, bool fill)
      : words_((length + 63) / 64),
        bits_(static_cast<std::size_t>(lines) * static_cast<std::size_t>(words_), fill ? ~std::uint64_t{0} : 0) {}

  [[nodiscard]] int words() const { return words_; }
  [[nodiscard]] std::uint64_t* line(int i) { return bits_.data() + static_cast<std::size_t>(i) * words_; }
  [[nodiscard]] const std::uint64_t* line(int i) const { return bits_.data() + static_cast<std::size_t>(i) * words_; }

  /// The 64 bits from `bit` on; zeros beyond the line.
  [[nodiscard]] std::uint64_t word_from(int i, int bit) const {
    const std::uint64_t* words = line(i);
    const int w = bit >> 6;
    const int shift = bit & 63;
    std::uint64_t word = words[w] >> shift;
    if (shift != 0 && w + 1 < words_) word |= words[w + 1] << (64 - shift);
    return word;
  }
  [[nodiscard]] bool test(int i, int bit) const { return (line(i)[bit >> 6] >> (bit & 63) & 1) != 0; }
  void assign(int i, int bit, bool value) {
    std::uint64_t& word = line(i)[bit >> 6];
    const std::uint64_t mask = std::uint64_t{1} << (bit & 63);
    word = value ? word | mask : word & ~mask;
  }
  /// Sets bits first to last, both included. @pre first <= last.
  void fill(int i, int first, int last) {
    std::uint64_t* words = line(i);
    const int end = last >> 6;
    std::uint64_t mask = ~std::uint64_t{0} << (first & 63);
    for (int w = first >> 6; w < end; ++w, mask = ~std::uint64_t{0}) words[w] |= mask;
    words[end] |= mask & ~std::uint64_t{0} >> (63 - (last & 63));
  }

  /// The first set bit above `bit`. @pre there is one.
  [[nodiscard]] int next(int i, int bit) const {
    const std::uint64_t* words = line(i);
    int w = (bit + 1) >> 6;
    std::uint64_t rest = words[w] & ~std::uint64_t{0} << ((bit + 1) & 63);
    while (rest == 0) rest = words[++w];
    return w << 6 | std::countr_zero(rest);
  }
  /// The last set bit below `bit`. @pre there is one.
  [[nodiscard]] int previous(int i, int bit) const {
    const std::uint64_t* words = line(i);
    int w = (bit - 1) >> 6;
    std::uint64_t rest = words[w] & ~std::uint64_t{0} >> (63 - ((bit - 1) & 63));
    while (rest == 0) rest = words[--w];
    return w << 6 | (63 - std::countl_zero(rest));
  }
  /// The first set bit above `bit` up to `last`; last + 1 where there is none.
  [[nodiscard]] int next(int i, int bit, int last) const {
    const std::uint64_t* words = line(i);
    for (int w = (bit + 1) >> 6; w <= last >> 6; ++w) {
      const std::uint64_t rest = w == (bit + 1) >> 6 ? words[w] & ~std::uint64_t{0} << ((bit + 1) & 63) : words[w];
      if (rest != 0) return std::min(w << 6 | std::countr_zero(rest), last + 1);
    }
    return last + 1;
  }
  /// The last set bit below `bit` down to `first`; first - 1 where there is none. @pre bit > 0.
  [[nodiscard]] int previous(int i, int bit, int first) const {
    const std::uint64_t* words = line(i);
    for (int w = (bit - 1) >> 6; w >= first >> 6; --w) {
      const std::uint64_t rest =
          w == (bit - 1) >> 6 ? words[w] & ~std::uint64_t{0} >> (63 - ((bit - 1) & 63)) : words[w];
      if (rest != 0) return std::max(w << 6 | (63 - std::countl_zero(rest)), first - 1);
    }
    return first - 1;
  }
  /// Whether bits first to last (both included) are all set. @pre first <= last.
  [[nodiscard]] bool all(int i, int first, int last) const {
    const std::uint64_t* words = line(i);
    const int end = last >> 6;
    std::uint64_t mask = ~std::uint64_t{0} << (first & 63);
    for (int w = first >> 6; w < end; ++w, mask = ~std::uint64_t{0}) {
      if ((words[w] & mask) != mask) return false;
    }
    mask &= ~std::uint64_t{0} >> (63 - (last & 63));
    return (words[end] & mask) == mask;
  }

 private:
  int words_ = 0;
  std::vector<std::uint64_t> bits_;
};

}  // namespace concord
