#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/byte_stream.hpp"
#include "core/error.hpp"

namespace concord::archive {

/// The frame of a map file (map_archive.md): what every section has, whatever stands in it.

using Tag = std::array<char, 4>;

inline constexpr Tag kLattice{'L', 'A', 'T', 'T'};
inline constexpr Tag kLayer{'L', 'A', 'Y', 'R'};
inline constexpr Tag kCorrections{'C', 'O', 'R', 'R'};
inline constexpr Tag kLabels{'L', 'A', 'B', 'L'};
inline constexpr Tag kEnd{'E', 'N', 'D', '.'};

/// Of each section named above.
inline constexpr std::uint32_t kVersion = 1;

[[nodiscard]] inline tl::unexpected<Error> malformed(const std::string& what) {
  return refuse(Code::kMalformed, "map file: " + what);
}

void append_file_head(Bytes& out);
/// Takes it off the front of `in`. Refused (kMalformed): another kind of file, a version that is not known.
[[nodiscard]] Result<void> take_file_head(ByteSpan& in);

/// Begins a section; what is appended after it is the section's, until end_section. Returns where it begins.
[[nodiscard]] std::size_t begin_section(Bytes& out, Tag tag, std::uint32_t version = kVersion);
void end_section(Bytes& out, std::size_t begin);

struct Section {
  Tag tag;
  std::uint32_t version;
  ByteSpan content;
};
/// Takes the next off the front of `in`. Refused (kMalformed): cut short, or not what its checksum says.
[[nodiscard]] Result<Section> take_section(ByteSpan& in);

inline void append_real(Bytes& out, double value) { append_le(out, std::bit_cast<std::uint64_t>(value)); }
/// @pre text.size() < 256.
void append_text(Bytes& out, std::string_view text);

/// Takes fields off the front of bytes. After one that was not there all are nothing, and `ok()` is false.
class FieldReader {
 public:
  explicit FieldReader(ByteSpan in) : in_(in) {}

  template <std::integral Int>
  [[nodiscard]] Int integer() {
    return noted(read_le<Int>(in_));
  }
  [[nodiscard]] std::uint64_t varint() { return noted(read_varint(in_)); }
  [[nodiscard]] double real() { return std::bit_cast<double>(integer<std::uint64_t>()); }
  /// 0 or 1.
  [[nodiscard]] bool flag();
  [[nodiscard]] std::string text();

  [[nodiscard]] bool ok() const { return ok_; }
  /// A field was there and is none that can be.
  void fail() { ok_ = false; }
  /// What is left, for readers of other codes.
  [[nodiscard]] ByteSpan& rest() { return in_; }

 private:
  template <class T>
  T noted(const std::optional<T>& value) {
    if (value && ok_) return *value;
    ok_ = false;
    return T{};
  }

  ByteSpan in_;
  bool ok_ = true;
};

}  // namespace concord::archive
