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

/// Reads an LCM event log as lcm-logger writes it, from front to back: no index, 28 bytes of big-endian header an
/// event.
class LogReader {
 public:
  /// Refused: a file that cannot be read (kIo).
  [[nodiscard]] static Result<LogReader> open(const std::filesystem::path& file);

  /// The next event; nothing at the end. Refused (kMalformed, with the place): bytes that are no event, one that ends
  /// early, a time before 1970; (kTooLarge): a message that LCM could not carry.
  [[nodiscard]] Result<std::optional<LogEvent>> next();

 private:
  LogReader(const std::filesystem::path& file, std::uintmax_t size);
  [[nodiscard]] tl::unexpected<Error> refuse_here(Code code, const std::string& what) const;

  std::string name_;
  std::ifstream in_;
  std::uintmax_t size_;
  std::uintmax_t at_ = 0;
};

}  // namespace concord
