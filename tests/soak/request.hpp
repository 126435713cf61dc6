#pragma once

#include <string>
#include <variant>

#include "core/corrections.hpp"
#include "core/requests.hpp"

namespace concord::soak {

/// What a person of the soak asks for.
using Request = std::variant<EditRequest, UndoRequest, ZoneRequest, WeightRequest, TransformRequest, LeaseRequest>;

[[nodiscard]] inline const std::string& id_of(const Request& request) {
  return std::visit([](const auto& of) -> const std::string& { return of.id; }, request);
}
[[nodiscard]] inline const std::string& author_of(const Request& request) {
  return std::visit([](const auto& of) -> const std::string& { return of.author; }, request);
}
/// A lease lasts seconds and is in no history.
[[nodiscard]] inline bool is_kept(const Request& request) { return !std::holds_alternative<LeaseRequest>(request); }

}  // namespace concord::soak
