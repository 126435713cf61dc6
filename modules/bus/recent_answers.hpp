#pragma once

#include <deque>
#include <map>
#include <string>
#include <utility>

#include "bus/messages.hpp"

namespace concord {

/// The latest answers a process gave: a request that comes again (its answer was lost) is answered alike, not done
/// again.
class RecentAnswers {
 public:
  static constexpr std::size_t kKept = 1000;

  explicit RecentAnswers(Bus& bus) : bus_(bus) {}

  /// Whether this request was answered before; then that answer was given once more.
  [[nodiscard]] bool repeat(const std::string& id) const {
    const auto it = by_id_.find(id);
    if (it == by_id_.end()) return false;
    answer(bus_, it->second);
    return true;
  }

  void give(Answer value) {
    answer(bus_, value);
    if (!by_id_.contains(value.id)) order_.push_back(value.id);
    by_id_[value.id] = std::move(value);
    if (order_.size() <= kKept) return;
    by_id_.erase(order_.front());
    order_.pop_front();
  }

 private:
  Bus& bus_;
  std::map<std::string, Answer> by_id_;
  std::deque<std::string> order_;  ///< oldest first
};

}  // namespace concord
