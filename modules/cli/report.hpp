#pragma once

#include <array>

#include <nlohmann/json.hpp>

#include "cli/live.hpp"
#include "cli/overview.hpp"

namespace concord {

/// The next list of agents that merge says. Fails with kNoAnswer.
[[nodiscard]] tl::expected<AgentList, Failure> hear_agents(Live& live);

/// Who asks: as named, else $USER, else who is logged in, else their number. The stack checks what was named.
[[nodiscard]] std::string author_or_user(const std::string& author);
/// Of an agent, a frame or a map.
[[nodiscard]] tl::unexpected<Failure> bad_name(const std::string& name);
/// What people give for --id, and edits and leases by their ids: what the wire takes, be it another program's.
[[nodiscard]] Result<void> check_id(const std::string& id);
/// The same; or none is given.
[[nodiscard]] Result<void> check_own_id(const std::string& id);
/// Prints what the stack did, or hands on its refusal.
[[nodiscard]] Outcome print_answer(const tl::expected<Answer, Failure>& answer, const Common& common);
/// The same of a correction: with its id, by which it can be found again, and its revision.
[[nodiscard]] Outcome print_revision(const tl::expected<Answer, Failure>& answer, const Common& common);

/// "x y z qx qy qz qw" as numbers.
[[nodiscard]] std::array<double, 7> to_numbers(const Transform& transform);

[[nodiscard]] nlohmann::json to_json(const AgentState& agent);
[[nodiscard]] nlohmann::json to_json(const Path& path);
[[nodiscard]] nlohmann::json to_json(const Answer& answer);

/// The path in a line for a person.
[[nodiscard]] std::string to_words(const Path& path);
/// Prints it. @return kNegative where there is none.
[[nodiscard]] Exit print_path(const Path& path, const Common& common);
/// As it is drawn.
[[nodiscard]] Overview::Route to_route(const Path& path);

}  // namespace concord
