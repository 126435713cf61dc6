#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bus/messages.hpp"

namespace concord {

/// `parts` in their order, at least one; `resolution` turns voxels into metres.
[[nodiscard]] nlohmann::json to_json(const std::vector<ConflictList>& parts, double resolution);
/// A table for a person.
[[nodiscard]] std::string to_words(const std::vector<ConflictList>& parts, double resolution);

}  // namespace concord
