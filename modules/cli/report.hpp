#pragma once

#include <array>

#include <nlohmann/json.hpp>

#include "cli/live.hpp"

namespace concord {

/// The next list of agents that merge says. Fails with kNoAnswer.
[[nodiscard]] tl::expected<AgentList, Failure> hear_agents(Live& live);

/// "x y z qx qy qz qw" as numbers.
[[nodiscard]] std::array<double, 7> to_numbers(const Transform& transform);

[[nodiscard]] nlohmann::json to_json(const AgentState& agent);
[[nodiscard]] nlohmann::json to_json(const Path& path);
[[nodiscard]] nlohmann::json to_json(const Answer& answer);

/// The path in a line for a person.
[[nodiscard]] std::string to_words(const Path& path);

}  // namespace concord
