#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/error.hpp"

namespace concord {

/// What a replay must lead to.
class Expected {
 public:
  /// Reads what `concord replay --json` printed, or a part of it. `live`: paths and answers depend on when the map
  /// reached the planner, so that only the map counts.
  /// Refused: a file that holds no JSON object (kIo), or none of the digests that count (kEmpty).
  [[nodiscard]] static Result<Expected> read(const std::filesystem::path& file, bool live);

  /// A line for each value that `result`, of the same form, has otherwise.
  [[nodiscard]] std::vector<std::string> differences(const nlohmann::json& result) const;

 private:
  explicit Expected(bool live) : live_(live) {}

  bool live_;
  std::map<std::string, nlohmann::json> digests_;
};

}  // namespace concord
