#pragma once

#include <nlohmann/json.hpp>

#include "cli/live.hpp"
#include "core/label_corrections.hpp"

namespace concord {

/// Asks semantic; the answer whole.
[[nodiscard]] tl::expected<std::vector<LabelInstance>, Failure> request_labels(Live& live, LabelQuery query);

[[nodiscard]] nlohmann::json to_json(const LabelInstance& instance, double resolution);
[[nodiscard]] std::string to_words(const std::vector<LabelInstance>& instances, double resolution);

}  // namespace concord
