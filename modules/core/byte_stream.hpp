#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace concord {

/// Bytes of our own formats: little endian on every machine. Each `read_` takes what it read off the front of `in`;
/// it answers nullopt, and leaves `in` as it was, when the bytes end early or are not the shortest form.

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;

template <std::integral Int>
void append_le(Bytes& out, Int value) {
  const auto bits = static_cast<std::make_unsigned_t<Int>>(value);
  for (unsigned i = 0; i < sizeof(Int); ++i) out.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
}

template <std::integral Int>
[[nodiscard]] std::optional<Int> read_le(ByteSpan& in) {
  if (in.size() < sizeof(Int)) return std::nullopt;
  std::uint64_t bits = 0;
  for (unsigned i = 0; i < sizeof(Int); ++i) bits |= std::uint64_t{in[i]} << (8 * i);
  in = in.subspan(sizeof(Int));
  return static_cast<Int>(bits);
}

inline constexpr int kMaxVarintBytes = 10;

/// Seven bits a byte, lowest first, the high bit says that more follow.
inline void append_varint(Bytes& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<std::uint8_t>(value | 0x80));
  out.push_back(static_cast<std::uint8_t>(value));
}

[[nodiscard]] inline std::optional<std::uint64_t> read_varint(ByteSpan& in) {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < kMaxVarintBytes && i < in.size(); ++i) {
    const std::uint8_t byte = in[i];
    value |= std::uint64_t{byte & 0x7Fu} << (7 * i);
    if ((byte & 0x80) != 0) continue;
    const bool overlong = byte == 0 && i > 0;
    const bool overflows = i == kMaxVarintBytes - 1 && byte > 1;
    if (overlong || overflows) return std::nullopt;
    in = in.subspan(i + 1);
    return value;
  }
  return std::nullopt;
}

/// Small numbers of either sign become small varints: 0, -1, 1, -2 ... as 0, 1, 2, 3 ...
[[nodiscard]] constexpr std::uint64_t zigzag(std::int64_t value) {
  return (static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63);
}
[[nodiscard]] constexpr std::int64_t unzigzag(std::uint64_t bits) {
  return static_cast<std::int64_t>((bits >> 1) ^ (~(bits & 1) + 1));
}

}  // namespace concord
