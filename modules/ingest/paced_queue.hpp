#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>

#include "bus/bus.hpp"

namespace concord {

/// Messages that go out in order and no faster than receivers can take: an answer in a thousand parts, sent at once,
/// would be lost in their socket buffers.
class PacedQueue {
 public:
  PacedQueue(Bus& bus, double bytes_per_second);

  /// `request` is what the message answers.
  void push(const std::string& request, std::string channel, Bytes bytes);
  /// Whether a message that answers this request has not gone out yet.
  [[nodiscard]] bool waits(const std::string& request) const { return waiting_.contains(request); }
  [[nodiscard]] std::size_t size() const { return queue_.size(); }

 private:
  struct Message {
    std::string request, channel;
    Bytes bytes;
  };

  void send_some();

  Bus& bus_;
  double bytes_per_step_;
  double budget_ = 0;  ///< bytes that may be sent now; below 0 after a message larger than the budget was
  std::deque<Message> queue_;
  std::map<std::string, std::size_t> waiting_;                  ///< messages in the queue, by request
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  ///< owns the timer
};

}  // namespace concord
