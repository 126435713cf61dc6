#pragma once

#include <cstdint>
#include <string>

namespace concord {

/// Numbers as people read them: 1234567 as "1,234,567".
[[nodiscard]] std::string format_count(std::int64_t count);
[[nodiscard]] std::string format_number(double value, int decimals);
/// Bytes as "1,235 kB", rounded up.
[[nodiscard]] std::string format_kilobytes(std::int64_t bytes);

/// A digest: 16 digits.
[[nodiscard]] std::string hex(std::uint64_t digest);

}  // namespace concord
