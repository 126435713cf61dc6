#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include "bus/bus.hpp"

namespace concord {

/// Messages that go out in order, at the pace that all streams of the bus share: an answer in a thousand parts, sent at
/// once, would be lost in its hearers' buffers.
class PartQueue {
 public:
  static constexpr std::size_t kMost = 10'000;  ///< messages

  PartQueue(Bus& bus, double bytes_per_second);
  PartQueue(const PartQueue&) = delete;
  PartQueue& operator=(const PartQueue&) = delete;

  [[nodiscard]] bool has_room(std::size_t messages) const { return queue_.size() + messages <= kMost; }
  /// @pre has_room(1).
  void push(std::string channel, Bytes bytes) { queue_.push_back({std::move(channel), std::move(bytes)}); }
  /// Sends what the pace allows now instead of at the next timer.
  void send_now();

 private:
  struct Message {
    std::string channel;
    Bytes bytes;
  };
  double send_one();

  Bus& bus_;
  double bytes_per_second_;
  std::deque<Message> queue_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  ///< timers of the bus outlive this
};

}  // namespace concord
