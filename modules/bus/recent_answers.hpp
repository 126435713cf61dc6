#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>

#include "bus/messages.hpp"

namespace concord {

/// What was answered lately: a request that comes again (its answer was lost) is answered alike, not done again.
/// A refusal holds for the copies that were under way when it was given, or one who was told no would have it done all
/// the same. Asked again later, it may be possible; who was told kBusy is to ask again at once.
class RecentAnswers {
 public:
  static constexpr std::size_t kKept = 1000;
  static constexpr std::int64_t kRefusalHolds = 1'000'000;  ///< microseconds

  explicit RecentAnswers(Bus& bus) : bus_(bus) {}

  /// Whether nothing more needs to be done: this request was answered before, and that answer was given once more; or
  /// its id belongs to another one that was granted, and it was refused (EXISTS). `content` tells requests of one id
  /// apart, and `asked` (its utime) those that were refused from the same asked anew.
  [[nodiscard]] bool repeat(const std::string& id, const std::string& process, std::uint64_t content,
                            std::int64_t asked = 0) const;

  void give(const Answer& value, std::uint64_t content, std::int64_t asked = 0);

 private:
  struct Given {
    Answer answer;
    std::uint64_t content;
    std::int64_t asked, utime;
  };

  Bus& bus_;
  std::map<std::string, Given> by_id_;
  std::deque<std::string> order_;  ///< oldest first
};

/// Of a request on the wire, its time left out: its kind and all that it asks.
[[nodiscard]] std::uint64_t content_of(const Bytes& message);

template <class Request>
[[nodiscard]] std::uint64_t content_of(const Request& request) {
  return content_of(encode(request, 0));
}

}  // namespace concord
