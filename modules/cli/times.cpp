#include "cli/times.hpp"

#include <cstdio>
#include <ctime>
#include <optional>
#include <regex>

namespace concord {
namespace {

constexpr std::int64_t kSecond = 1'000'000;
constexpr std::size_t kLongest = 40;  // characters: std::regex recurses

std::optional<std::int64_t> parse_ago(const std::string& text, std::int64_t now) {
  static const std::regex kAgo(R"((\d{1,9})([smhd]))");
  std::smatch match;
  if (!std::regex_match(text, match, kAgo)) return std::nullopt;
  const char unit = *match[2].first;
  const std::int64_t seconds = unit == 's' ? 1 : unit == 'm' ? 60 : unit == 'h' ? 3600 : 86'400;
  const std::int64_t count = std::stoll(match[1]), unit_utime = seconds * kSecond;
  return count > now / unit_utime ? 0 : now - count * unit_utime;
}

int number(const std::ssub_match& match) { return match.matched ? std::stoi(match) : 0; }

/// Microseconds of "5" are 500,000.
std::int64_t fraction(std::string digits) {
  digits.resize(6, '0');
  return std::stoll(digits);
}

/// Minutes east of Greenwich; absent for one that no clock shows.
std::optional<int> parse_offset(const std::string& text) {
  if (text == "Z") return 0;
  const int hours = std::stoi(text.substr(1, 2)), minutes = std::stoi(text.substr(text.size() - 2));
  if (hours > 14 || minutes > 59) return std::nullopt;
  return (text[0] == '-' ? -1 : 1) * (hours * 60 + minutes);
}

std::optional<std::int64_t> parse_iso(const std::string& text) {
  static const std::regex kIso(
      R"((\d{4})-(\d\d)-(\d\d)(?:[T ](\d\d):(\d\d)(?::(\d\d)(?:[.,](\d{1,6}))?)?(Z|[+-]\d\d:?\d\d)?)?)");
  std::smatch match;
  if (!std::regex_match(text, match, kIso)) return std::nullopt;
  std::tm time = {};
  time.tm_year = number(match[1]) - 1900;
  time.tm_mon = number(match[2]) - 1;
  time.tm_mday = number(match[3]);
  time.tm_hour = number(match[4]);
  time.tm_min = number(match[5]);
  time.tm_sec = number(match[6]);
  time.tm_isdst = -1;
  if (time.tm_hour > 23 || time.tm_min > 59 || time.tm_sec > 59) return std::nullopt;
  const std::tm asked = time;
  std::time_t seconds = 0;
  if (match[8].matched) {
    const auto offset = parse_offset(match[8]);
    if (!offset) return std::nullopt;
    seconds = timegm(&time) - *offset * 60;
  } else {
    seconds = std::mktime(&time);
  }
  // The 30th of February comes back as the 2nd of March.
  if (time.tm_mon != asked.tm_mon || time.tm_mday != asked.tm_mday) return std::nullopt;
  return seconds * kSecond + (match[7].matched ? fraction(match[7]) : 0);
}

std::string format(const std::tm& time, const char* how) {
  char text[64];
  return {text, std::strftime(text, sizeof(text), how, &time)};
}

/// Whole seconds, also before 1970.
std::time_t seconds_of(std::int64_t utime) { return utime / kSecond - (utime % kSecond < 0 ? 1 : 0); }

}  // namespace

Result<std::int64_t> parse_time(const std::string& text, std::int64_t now) {
  std::optional<std::int64_t> utime;
  if (text.size() <= kLongest) {
    utime = parse_ago(text, now);
    if (!utime) utime = parse_iso(text);
  }
  if (!utime) {
    return refuse(Code::kMalformed,
                  "'" + text.substr(0, kLongest) +
                      "' is no time: 2026-11-22T07:15 (local; or with Z, +01:00), or 10m, 2h, 3d ago");
  }
  if (*utime <= 0) return refuse(Code::kBadRequest, "'" + text + "' lies before 1970");
  return *utime;
}

std::string format_local_time(std::int64_t utime) {
  const std::time_t seconds = seconds_of(utime);
  std::tm time = {};
  localtime_r(&seconds, &time);
  return format(time, "%F %T");
}

std::string format_utc_time(std::int64_t utime) {
  const std::time_t seconds = seconds_of(utime);
  std::tm time = {};
  gmtime_r(&seconds, &time);
  char microseconds[16];
  std::snprintf(microseconds, sizeof(microseconds), ".%06dZ", static_cast<int>(utime - seconds * kSecond));
  return format(time, "%FT%T") + microseconds;
}

}  // namespace concord
