#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>

#include "bus/bus.hpp"

namespace concord {

/// Answers of many messages that go out in order, at the pace that all streams of the bus share: a thousand parts, sent
/// at once, would be lost in their hearers' buffers.
class ReplyQueue {
 public:
  static constexpr std::size_t kMost = 50'000;  ///< messages

  ReplyQueue(Bus& bus, double bytes_per_second);
  ReplyQueue(const ReplyQueue&) = delete;
  ReplyQueue& operator=(const ReplyQueue&) = delete;

  [[nodiscard]] bool has_room(std::size_t messages) const { return queue_.size() + messages <= kMost; }
  /// `request` is what the message answers. @pre has_room(1).
  void push(const std::string& request, std::string channel, Bytes bytes);
  /// Whether a message that answers this request has not gone out yet.
  [[nodiscard]] bool waits(const std::string& request) const { return waiting_.contains(request); }
  /// Sends what the pace allows now instead of at the next timer.
  void send_now();

 private:
  struct Message {
    std::string request, channel;
    Bytes bytes;
  };
  double send_one();

  Bus& bus_;
  double bytes_per_second_;
  std::deque<Message> queue_;
  std::map<std::string, std::size_t> waiting_;                  ///< messages in the queue, by request
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  ///< owns the timer
};

}  // namespace concord
