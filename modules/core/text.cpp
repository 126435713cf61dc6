#include "core/text.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <utility>

namespace concord {
namespace {

/// Takes the first code point off `text`; none: no UTF-8.
std::optional<std::uint32_t> next_code(std::string_view& text) {
  const auto lead = static_cast<std::uint8_t>(text.front());
  const std::size_t length = lead < 0x80 ? 1 : lead >= 0xC2 && lead < 0xE0 ? 2 : lead >= 0xE0 && lead < 0xF0 ? 3 : 4;
  if (lead == 0 || (lead >= 0x80 && lead < 0xC2) || lead > 0xF4 || length > text.size()) return std::nullopt;
  std::uint32_t code = length == 1 ? lead : lead & (0x7Fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    const auto next = static_cast<std::uint8_t>(text[i]);
    if ((next & 0xC0) != 0x80) return std::nullopt;
    code = code << 6 | (next & 0x3Fu);
  }
  const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool surrogate = code >= 0xD800 && code < 0xE000;
  if (overlong || surrogate || code > 0x10FFFF) return std::nullopt;
  text.remove_prefix(length);
  return code;
}

template <class Fine>
bool all_codes(std::string_view text, Fine fine) {
  while (!text.empty()) {
    const auto code = next_code(text);
    if (!code || !fine(*code)) return false;
  }
  return true;
}

struct CodeRange {
  std::uint32_t first, last;
};

/// Controls, line and paragraph separators, and of Unicode's format and ignorable characters those that turn text
/// around or cannot be seen. Ascending. The joiners U+200C and U+200D are among them, so are variation selectors: two
/// names that differ by them only look alike.
constexpr CodeRange kUnseen[] = {
    {0x00, 0x1F},     {0x7F, 0x9F},       {0xAD, 0xAD},       {0x34F, 0x34F},     {0x600, 0x605},   {0x61C, 0x61C},
    {0x6DD, 0x6DD},   {0x70F, 0x70F},     {0x115F, 0x1160},   {0x17B4, 0x17B5},   {0x180B, 0x180F}, {0x200B, 0x200F},
    {0x2028, 0x202E}, {0x2060, 0x206F},   {0x3164, 0x3164},   {0xFE00, 0xFE0F},   {0xFEFF, 0xFEFF}, {0xFFA0, 0xFFA0},
    {0xFFF0, 0xFFFB}, {0x1BCA0, 0x1BCA3}, {0x1D173, 0x1D17A}, {0xE0000, 0xE0FFF},
};

bool is_seen(std::uint32_t code) {
  const auto* range = std::ranges::lower_bound(kUnseen, code, {}, &CodeRange::last);
  return range == std::end(kUnseen) || code < range->first;
}

/// Unicode's space separators (Zs).
bool is_space(std::uint32_t code) {
  return code == 0x20 || code == 0xA0 || code == 0x1680 || (code >= 0x2000 && code <= 0x200A) || code == 0x202F ||
         code == 0x205F || code == 0x3000;
}

/// Printable, with no space at either end.
bool is_tidy(std::string_view text) {
  bool starts = true, space = false;
  const bool fine = all_codes(text, [&](std::uint32_t code) {
    space = is_space(code);
    const bool at_start = std::exchange(starts, false);
    return is_seen(code) && !(at_start && space);
  });
  return fine && !space;
}

}  // namespace

std::string cut_to(std::string_view text, std::size_t most_bytes) {
  std::size_t end = std::min(text.size(), most_bytes);
  const auto is_inside = [&](std::size_t at) { return (static_cast<std::uint8_t>(text[at]) & 0xC0) == 0x80; };
  while (end > 0 && end < text.size() && is_inside(end)) --end;
  return std::string(text.substr(0, end));
}

bool is_utf8(std::string_view text) {
  return all_codes(text, [](std::uint32_t) { return true; });
}

bool is_line(std::string_view text) {
  return all_codes(text, [](std::uint32_t code) { return code >= 0x20 && code != 0x7F; });
}

bool is_printable(std::string_view text) { return all_codes(text, is_seen); }

bool is_name(std::string_view text) {
  const auto alphanumeric = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
  };
  if (text.empty() || text.size() > kMaxNameBytes || !alphanumeric(text.front())) return false;
  return std::ranges::all_of(text, [&](char c) { return alphanumeric(c) || c == '.' || c == '_' || c == '-'; });
}

bool is_title(std::string_view text) {
  return text.size() <= kMaxTitleBytes && text.find_first_not_of('.') != text.npos &&
         text.find_first_of("/\\") == text.npos && is_tidy(text);
}

bool is_kept_title(std::string_view text) {
  return !text.empty() && text.size() <= kMaxTitleBytes && text.find_first_of("/\\") == text.npos && is_line(text);
}

bool is_kept_id(std::string_view text) { return !text.empty() && is_kept_author(text); }

bool is_kept_author(std::string_view text) { return text.size() <= kMaxIdBytes && is_line(text); }

bool is_request_id(std::string_view text) { return !text.empty() && text.size() <= kMaxIdBytes && is_tidy(text); }

bool is_author(std::string_view text) { return text.size() <= kMaxIdBytes && is_tidy(text); }

}  // namespace concord
