#include "core/map_archive_sections.hpp"

#include <algorithm>
#include <cassert>

#include <xxhash.h>

namespace concord::archive {
namespace {

// A byte that is no text, the name, and line ends that a transfer as text would change.
constexpr std::array<std::uint8_t, 12> kMagic{0x89, 'C', 'O', 'N', 'C', 'O', 'R', 'D', '\r', '\n', 0x1A, '\n'};
constexpr std::uint32_t kFileVersion = 1;

constexpr std::size_t kLengthAt = 4 + 4;
constexpr std::size_t kChecksumAt = kLengthAt + 8;
constexpr std::size_t kHeadBytes = kChecksumAt + 8;

/// Of the tag, version and length as well: a damaged tag must not make a section an unknown one.
std::uint64_t checksum(ByteSpan head, ByteSpan content) {
  return XXH3_64bits_withSeed(content.data(), content.size(), XXH3_64bits(head.data(), head.size()));
}

void put_le(Bytes& out, std::size_t at, std::uint64_t value) {
  for (unsigned i = 0; i < 8; ++i) out[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

}  // namespace

void append_file_head(Bytes& out) {
  out.insert(out.end(), kMagic.begin(), kMagic.end());
  append_le(out, kFileVersion);
}

Result<void> take_file_head(ByteSpan& in) {
  if (in.size() < kMagic.size() || !std::equal(kMagic.begin(), kMagic.end(), in.begin())) {
    return malformed("this is no .concord file");
  }
  ByteSpan rest = in.subspan(kMagic.size());
  const auto version = read_le<std::uint32_t>(rest);
  if (!version) return malformed("cut short");
  if (*version != kFileVersion) {
    return malformed("it has version " + std::to_string(*version) + ", this program knows " +
                     std::to_string(kFileVersion) + "; run a newer one");
  }
  in = rest;
  return {};
}

std::size_t begin_section(Bytes& out, Tag tag, std::uint32_t version) {
  const std::size_t begin = out.size();
  out.insert(out.end(), tag.begin(), tag.end());
  append_le(out, version);
  out.resize(begin + kHeadBytes);
  return begin;
}

void end_section(Bytes& out, std::size_t begin) {
  put_le(out, begin + kLengthAt, out.size() - begin - kHeadBytes);
  const ByteSpan section = ByteSpan(out).subspan(begin);
  put_le(out, begin + kChecksumAt, checksum(section.first(kChecksumAt), section.subspan(kHeadBytes)));
}

Result<Section> take_section(ByteSpan& in) {
  if (in.size() < kHeadBytes) return malformed("cut short; copy it again");
  Section section{};
  std::copy_n(in.begin(), section.tag.size(), section.tag.begin());
  ByteSpan head = in.subspan(section.tag.size(), kHeadBytes - section.tag.size());
  section.version = *read_le<std::uint32_t>(head);
  const auto length = *read_le<std::uint64_t>(head);
  const auto expected = *read_le<std::uint64_t>(head);
  if (length > in.size() - kHeadBytes) return malformed("cut short; copy it again");
  section.content = in.subspan(kHeadBytes, length);
  if (checksum(in.first(kChecksumAt), section.content) != expected) {
    return malformed("damaged; copy it again, or take another one");
  }
  in = in.subspan(kHeadBytes + length);
  return section;
}

void append_text(Bytes& out, std::string_view text) {
  assert(text.size() < 256);
  append_le(out, static_cast<std::uint8_t>(text.size()));
  out.insert(out.end(), text.begin(), text.end());
}

bool FieldReader::flag() {
  const auto value = integer<std::uint8_t>();
  if (value > 1) fail();
  return value == 1;
}

std::string FieldReader::text() {
  const auto size = integer<std::uint8_t>();
  if (!ok_ || in_.size() < size) {
    fail();
    return {};
  }
  std::string text(in_.begin(), in_.begin() + size);
  in_ = in_.subspan(size);
  return text;
}

}  // namespace concord::archive
