#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "core/alignment.hpp"

namespace concord {

/// What an alignment was judged by, as the client says it.
[[nodiscard]] nlohmann::json to_json(const Alignment& evidence);
[[nodiscard]] std::string to_words(const Alignment& evidence);

/// The same with who was looked at, up to which revision.
[[nodiscard]] nlohmann::json to_json(const AlignResult& result);
[[nodiscard]] std::string to_words(const AlignResult& result);
/// "robot2 in the map", "robot2 in robot1".
[[nodiscard]] std::string pair_of(const AlignResult& result);

}  // namespace concord
