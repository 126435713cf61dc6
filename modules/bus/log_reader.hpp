#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "core/byte_stream.hpp"
#include "core/error.hpp"

namespace concord {

/// One message of an LCM event log.
struct LogEvent {
  std::int64_t utime = 0;  ///< when the logger heard it
  std::string channel;
  Bytes bytes;
};

/// Where a log breaks off within an event: its logger was ended by force, or its machine lost power.
struct LogCut {
  std::int64_t whole_events = 0;  ///< before it
  std::uintmax_t byte = 0;        ///< where the broken event begins: the log is whole up to there
  std::uintmax_t bytes_lost = 0;  ///< from there to the end of the file
};

/// Reads an LCM event log as lcm-logger writes it, from front to back: no index, 28 bytes of big-endian header an
/// event.
class LogReader {
 public:
  /// Refused: a file that cannot be read (kIo).
  [[nodiscard]] static Result<LogReader> open(const std::filesystem::path& file);

  /// The next event; nothing at the end, and where the log is cut. Refused (kMalformed, with the place): bytes that are
  /// no event, a time before 1970; (kTooLarge): a message that LCM could not carry.
  [[nodiscard]] Result<std::optional<LogEvent>> next();

  /// Set when `next` came to an end within an event: the file ends, or only zeros follow (room for what was never
  /// written).
  [[nodiscard]] const std::optional<LogCut>& cut() const { return cut_; }
  /// How many events `next` has given, and the byte where the one after them begins.
  [[nodiscard]] std::int64_t events() const { return events_; }
  [[nodiscard]] std::uintmax_t at() const { return at_; }

 private:
  LogReader(const std::filesystem::path& file, std::uintmax_t size);
  std::nullopt_t cut_here();
  [[nodiscard]] bool only_zeros_left();
  [[nodiscard]] tl::unexpected<Error> refuse_here(Code code, const std::string& what) const;

  std::string name_;
  std::ifstream in_;
  std::uintmax_t size_;
  std::uintmax_t at_ = 0;
  std::int64_t events_ = 0;
  std::optional<LogCut> cut_;
};

}  // namespace concord
