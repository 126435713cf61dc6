#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "semantic/brick_masks.hpp"

namespace concord {

/// The box around voxels, metres: {"min": [x, y, z], "max": ...}; null around none.
[[nodiscard]] nlohmann::json box_json(const BrickMasks& voxels, double resolution);
/// The same for people.
[[nodiscard]] std::string box_words(const BrickMasks& voxels, double resolution);

}  // namespace concord
