#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bus/messages.hpp"

namespace concord {

/// The latest status of each process, by its name.
using Statuses = std::map<std::string, ProcessStatus>;

/// The processes of a stack that were not heard, in their order.
[[nodiscard]] std::vector<std::string> missing(const Statuses& heard);
[[nodiscard]] nlohmann::json to_json(const Statuses& heard);
[[nodiscard]] std::string to_words(const Statuses& heard);

}  // namespace concord
