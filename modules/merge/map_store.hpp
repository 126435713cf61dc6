#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/brick_map.hpp"
#include "core/error.hpp"
#include "core/octomap_format.hpp"

namespace concord {

/// The folder of saved maps: NAME.bt and NAME.ot, which OctoMap's tools read. Names come checked (is_name).
class MapStore {
 public:
  explicit MapStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Writes the whole file, synced, before it takes its name; an interrupted save leaves the old one.
  /// Refused: kExists unless `overwrite`, kIo, and what write_octomap_file refuses. Returns the bytes written.
  [[nodiscard]] Result<std::int64_t> save(const BrickMap& map, double resolution, const std::string& name,
                                          const std::string& format, bool overwrite) const;

  /// File names with extension and sizes, sorted.
  [[nodiscard]] Result<std::vector<std::pair<std::string, std::int64_t>>> list() const;

 private:
  std::filesystem::path folder_;
};

}  // namespace concord
