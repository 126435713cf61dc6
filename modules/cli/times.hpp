#pragma once

#include <cstdint>
#include <string>

#include "core/error.hpp"

namespace concord {

/// A moment as a person writes it, microseconds since 1970: ISO 8601 ("2026-11-22", "2026-11-22T07:15",
/// "2026-11-22T07:15:30.5", local time unless "Z" or an offset such as "+01:00" follows), or so long before `now`:
/// "30s", "10m", "2h", "3d". Refused: anything else (kMalformed), a moment before 1970 (kBadRequest).
[[nodiscard]] Result<std::int64_t> parse_time(const std::string& text, std::int64_t now);

/// "2026-11-22 07:15:30" where this program runs.
[[nodiscard]] std::string format_local_time(std::int64_t utime);
/// "2026-11-22T07:15:30.123456Z", to the microsecond.
[[nodiscard]] std::string format_utc_time(std::int64_t utime);

}  // namespace concord
