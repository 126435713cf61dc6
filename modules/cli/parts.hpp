#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/live.hpp"

namespace concord {

/// The parts of one answer (`part` of `parts`); they may come in any order and more than once.
template <class Part>
class Parts {
 public:
  void take(Part part, std::int64_t now) {
    // Asked again, the answer may have changed: what was heard before belongs to another.
    if (!heard_.empty() && heard_.begin()->second.parts != part.parts) heard_.clear();
    const std::int32_t index = part.part;
    heard_.insert_or_assign(index, std::move(part));
    last_heard_ = now;
  }

  [[nodiscard]] bool any() const { return !heard_.empty(); }
  [[nodiscard]] bool complete() const {
    return any() && static_cast<std::int32_t>(heard_.size()) == heard_.begin()->second.parts;
  }
  [[nodiscard]] std::int64_t last_heard() const { return last_heard_; }
  [[nodiscard]] std::vector<Part> in_order() const {
    std::vector<Part> all;
    for (const auto& [index, part] : heard_) all.push_back(part);
    return all;
  }

 private:
  std::map<std::int32_t, Part> heard_;
  std::int64_t last_heard_ = 0;
};

/// Where and of whom something is asked that is answered in parts.
struct Respondent {
  std::string channel;
  std::string who;                   ///< the process that answers, for words
  std::string answers;               ///< the channel of the parts
  std::int64_t silence = kAskAgain;  ///< microseconds without a part after which some are taken for lost
};

/// Asks until all parts have come, and again only when none has come for a while: a long answer is on its way for
/// seconds. Fails with what it was refused for, kNoAnswer, or kIncomplete.
template <class Part, class Request>
[[nodiscard]] tl::expected<std::vector<Part>, Failure> ask_in_parts(Live& live, const Respondent& respondent,
                                                                    const Request& request) {
  const auto bytes = to_send(request, live.bus().now());
  if (!bytes) return tl::unexpected(bytes.error());
  const auto parts = std::make_shared<Parts<Part>>();  // the subscription outlives this call
  live.hear<Part>(respondent.answers, [parts, id = request.id, &live](const std::string&, Part part) {
    if (part.id == id) parts->take(std::move(part), live.bus().now());
  });
  const auto is_refused = [&] {
    const Answer* answer = live.answer_to(request.id);
    return answer != nullptr && !answer->ok && !is_busy(*answer);
  };
  std::int64_t asked = 0;
  live.wait(live.timeout(), [&] {
    const std::int64_t now = live.bus().now();
    if (parts->complete() || is_refused()) return true;
    if (now - std::max(asked, parts->last_heard()) > respondent.silence) {
      live.bus().publish(respondent.channel, *bytes);
      asked = now;
    }
    return false;
  });
  if (is_refused()) return refused(*live.answer_to(request.id));
  if (!parts->any()) {
    const Answer* answer = live.answer_to(request.id);
    if (answer != nullptr && !answer->ok) return refused(*answer);  // busy all the time
    return live.no_answer(respondent.who);
  }
  if (!parts->complete()) {
    return fail(Exit::kIncomplete, "INCOMPLETE", "parts of the answer did not arrive; give a longer --timeout");
  }
  return parts->in_order();
}

}  // namespace concord
