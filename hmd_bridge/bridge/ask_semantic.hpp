#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bridge/desk.hpp"
#include "bus/messages_label.hpp"

namespace concord::hmd {

/// A code of the stack as one of the protocol, in the answer to one request; empty: as it is called elsewhere.
using Translation = std::function<Code(const std::string&)>;

/// Asks semantic one thing, of this id, and goes on with its answer; refuses the client what it refuses.
/// @param with_list whether it tells instances (`out/label_list`) with its answer; else there are none.
void ask_semantic(Desk& desk, const Ask& ask, const std::string& id, const std::string& channel, Bytes message,
                  bool with_list, std::function<void(const Answer&, const std::vector<LabelInstance>&)> then,
                  Translation translate = {});

/// The labelled things as they show, of all classes or (by its number) of one; refuses the client kNoLabel if there is
/// no such class.
void ask_instances(Desk& desk, const Ask& ask, std::optional<ClassId> label,
                   std::function<void(const std::vector<LabelInstance>&)> then);

/// The lowest and highest corner of what shows, metres.
struct Corners {
  std::array<double, 3> min, max;
};
[[nodiscard]] Corners corners_of(const LabelInstance& instance, double resolution);

}  // namespace concord::hmd
