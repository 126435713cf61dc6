#pragma once

#include <nlohmann/json.hpp>

#include "cli/live.hpp"
#include "core/label_corrections.hpp"

namespace concord {

/// Asks semantic; the answer whole.
[[nodiscard]] tl::expected<std::vector<LabelInstance>, Failure> request_labels(Live& live, LabelQuery query);

/// The number that a class has now, be it that nothing of it shows.
[[nodiscard]] tl::expected<ClassId, Failure> class_called(Live& live, const std::string& name);

[[nodiscard]] nlohmann::json to_json(const LabelInstance& instance, double resolution);
[[nodiscard]] std::string to_words(const std::vector<LabelInstance>& instances, double resolution);

}  // namespace concord
