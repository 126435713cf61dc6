#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace concord {

/// The shape of a generated LCM type, to be walked before its decoder is called: the generated code takes
/// memory for whatever counts it finds and has undefined behaviour on a negative string length.
struct WireField {
  enum class Kind {
    kFixed,   ///< `bytes` bytes
    kText,    ///< int32 length with terminating zero, at most `bytes` bytes of UTF-8
    kCount,   ///< int32, 0 to `bytes`; what the following arrays repeat
    kArray,   ///< the last count times `bytes` bytes
    kTexts,   ///< the last count times a text of at most `bytes` characters
    kRecord,  ///< `record` once
    kRecords  ///< the last count times `record`, whose own counts end with it
  };
  Kind kind;
  std::int64_t bytes;
  std::span<const WireField> record = {};
};

[[nodiscard]] constexpr WireField fixed(std::int64_t bytes) { return {WireField::Kind::kFixed, bytes}; }
[[nodiscard]] constexpr WireField text(std::int64_t most) { return {WireField::Kind::kText, most}; }
[[nodiscard]] constexpr WireField count(std::int64_t most) { return {WireField::Kind::kCount, most}; }
[[nodiscard]] constexpr WireField array(std::int64_t bytes_each) { return {WireField::Kind::kArray, bytes_each}; }
[[nodiscard]] constexpr WireField texts(std::int64_t most) { return {WireField::Kind::kTexts, most}; }
[[nodiscard]] constexpr WireField record(std::span<const WireField> record) {
  return {WireField::Kind::kRecord, 0, record};
}
[[nodiscard]] constexpr WireField records(std::span<const WireField> record) {
  return {WireField::Kind::kRecords, 0, record};
}

enum class WireFit { kFits, kMalformed, kTooLarge };

struct WireCheck {
  WireFit fit = WireFit::kFits;
  std::string excess;  ///< if too large: what is over which limit, for a person
};

/// Whether `bytes` (fingerprint included) is exactly one message of this shape, within its limits.
[[nodiscard]] WireCheck check_layout(std::span<const std::uint8_t> bytes, std::span<const WireField> layout);

/// The text of at most `most` bytes that stands `offset` bytes behind the fingerprint; none: there is no such text.
[[nodiscard]] std::optional<std::string> text_at(std::span<const std::uint8_t> bytes, std::int64_t offset,
                                                 std::int64_t most);

}  // namespace concord
