#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "core/alignment.hpp"

namespace concord {

/// What an alignment was judged by, as the client says it.
[[nodiscard]] nlohmann::json to_json(const Alignment& evidence);
[[nodiscard]] std::string to_words(const Alignment& evidence);

/// The same with who was looked at, up to which revision.
[[nodiscard]] nlohmann::json to_json(const AlignResult& result);
[[nodiscard]] std::string to_words(const AlignResult& result);
/// The picture failed; what was found has been printed and stands, so this goes to standard error.
/// @return what the caller is told: `verdict` if it is a refusal, else what the picture failed with.
[[nodiscard]] Exit say_undrawn(const Failure& failure, Exit verdict);
/// "robot2 in the map", "robot2 in robot1".
[[nodiscard]] std::string pair_of(const AlignResult& result);

}  // namespace concord
