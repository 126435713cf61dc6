#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "cli/live.hpp"

namespace concord {

/// Every operation that the request matches, page after page, at most `most` of them. `id` and `most` of the request
/// are filled in. Fails as ask_in_parts does.
[[nodiscard]] tl::expected<std::vector<Operation>, Failure> request_history(Live& live, HistoryRequest request,
                                                                            std::int64_t most);

/// "add", "zone-change" and so on, as --kind takes them.
[[nodiscard]] std::string word_for(Operation::Kind kind);

/// `resolution` turns voxels into metres.
[[nodiscard]] nlohmann::json to_json(const std::vector<Operation>& operations, double resolution);
/// A table for a person, times where this program runs.
[[nodiscard]] std::string to_words(const std::vector<Operation>& operations, double resolution);
/// RFC 4180, with a header; times in UTC; where an operation pins nothing, its bounds are empty.
[[nodiscard]] std::string to_csv(const std::vector<Operation>& operations, double resolution);

}  // namespace concord
