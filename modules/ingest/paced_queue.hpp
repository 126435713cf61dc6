#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <utility>

#include "bus/bus.hpp"

namespace concord {

/// Messages that go out in order and no faster than receivers can take: an answer in a thousand parts, sent at once,
/// would be lost in their socket buffers.
class PacedQueue {
 public:
  PacedQueue(Bus& bus, double bytes_per_second);

  void push(std::string channel, Bytes bytes);
  [[nodiscard]] std::size_t size() const { return queue_.size(); }

 private:
  void send_some();

  Bus& bus_;
  double bytes_per_step_;
  double budget_ = 0;  ///< bytes that may be sent now; below 0 after a message larger than the budget was
  std::deque<std::pair<std::string, Bytes>> queue_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  ///< timers of the bus outlive this
};

}  // namespace concord
