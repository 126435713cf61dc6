#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/byte_stream.hpp"
#include "core/error.hpp"

namespace concord {

/// The folder of saved maps: NAME.bt and NAME.ot, which OctoMap's tools read, and NAME.concord (core/map_archive.md).
/// Names come checked (is_name).
class MapStore {
 public:
  explicit MapStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Whether a map may take this name. Refused: kExists unless `overwrite`; kIo: something that is no file has it.
  [[nodiscard]] Result<void> check(const std::string& name, const std::string& format, bool overwrite) const;
  /// By format.
  using Files = std::vector<std::pair<std::string, Bytes>>;
  /// Writes the whole files, synced, before any takes its name: a refused save leaves the old ones. Refused: kIo.
  [[nodiscard]] Result<void> save(const std::string& name, const Files& files) const;

  [[nodiscard]] bool contains(const std::string& name, const std::string& format) const;
  /// Refused: kNotFound, kTooLarge (before memory is taken), kIo.
  [[nodiscard]] Result<Bytes> read(const std::string& name, const std::string& format, std::uint64_t most) const;

  /// What changes when the file does.
  struct Version {
    std::uintmax_t bytes = 0;
    std::filesystem::file_time_type written;
    bool operator==(const Version&) const = default;
  };
  /// Refused: kNotFound, kIo.
  [[nodiscard]] Result<Version> version(const std::string& name, const std::string& format) const;

  /// File names with extension and sizes, sorted.
  [[nodiscard]] Result<std::vector<std::pair<std::string, std::int64_t>>> list() const;

 private:
  [[nodiscard]] std::filesystem::path path_of(const std::string& name, const std::string& format) const {
    return folder_ / (name + "." + format);
  }

  std::filesystem::path folder_;
};

}  // namespace concord
