#include "cli/numbers.hpp"

#include <cinttypes>
#include <cstdio>

namespace concord {

std::string format_count(std::int64_t count) {
  const std::string digits = std::to_string(count);
  const std::size_t sign = count < 0 ? 1 : 0;
  std::string grouped;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > sign && (digits.size() - i) % 3 == 0) grouped += ',';
    grouped += digits[i];
  }
  return grouped;
}

std::string format_number(double value, int decimals) {
  char text[400];  // the largest double has 309 digits
  std::snprintf(text, sizeof(text), "%.*f", decimals, value);
  return text;
}

std::string format_kilobytes(std::int64_t bytes) { return format_count((bytes + 999) / 1000) + " kB"; }

std::string hex(std::uint64_t digest) {
  char text[17];
  std::snprintf(text, sizeof(text), "%016" PRIx64, digest);
  return text;
}

}  // namespace concord
