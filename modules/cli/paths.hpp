#pragma once

#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "core/requests.hpp"

namespace concord {

/// The paths that are kept up to date, by robot.
using KeptPaths = std::map<std::string, Path>;

/// Takes what the planner said of one path.
void take(KeptPaths& kept, const Path& path);
[[nodiscard]] nlohmann::json to_json(const KeptPaths& kept);
/// A table for a person.
[[nodiscard]] std::string to_words(const KeptPaths& kept);

}  // namespace concord
