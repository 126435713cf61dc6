#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "core/alignment.hpp"

namespace concord {

/// What an alignment was judged by, as the client says it.
[[nodiscard]] nlohmann::json to_json(const AlignEvidence& evidence);
[[nodiscard]] std::string to_words(const AlignEvidence& evidence);

}  // namespace concord
