#include "ingest/paced_queue.hpp"

#include <algorithm>
#include <utility>

namespace concord {
namespace {

constexpr std::int64_t kStep = 5'000;

}  // namespace

PacedQueue::PacedQueue(Bus& bus, double bytes_per_second)
    : bus_(bus), bytes_per_step_(bytes_per_second * static_cast<double>(kStep) * 1e-6) {
  bus_.every(
      kStep, [this] { send_some(); }, alive_);
}

void PacedQueue::push(const std::string& request, std::string channel, Bytes bytes) {
  queue_.push_back({request, std::move(channel), std::move(bytes)});
  ++waiting_[request];
}

void PacedQueue::send_some() {
  budget_ = std::min(budget_ + bytes_per_step_, bytes_per_step_);
  while (!queue_.empty() && budget_ > 0) {
    const Message& message = queue_.front();
    bus_.publish(message.channel, message.bytes);
    budget_ -= static_cast<double>(message.bytes.size());
    const auto waiting = waiting_.find(message.request);
    if (--waiting->second == 0) waiting_.erase(waiting);
    queue_.pop_front();
  }
}

}  // namespace concord
