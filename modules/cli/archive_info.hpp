#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "core/map_archive.hpp"

namespace concord {

/// What a native map file holds: its layers, who corrected what, and the zones that this has led to.
[[nodiscard]] nlohmann::json to_json(const MapArchive& archive);
[[nodiscard]] std::string to_words(const MapArchive& archive);

}  // namespace concord
