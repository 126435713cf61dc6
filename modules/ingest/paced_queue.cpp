#include "ingest/paced_queue.hpp"

#include <algorithm>

namespace concord {
namespace {

constexpr std::int64_t kStep = 5'000;

}  // namespace

PacedQueue::PacedQueue(Bus& bus, double bytes_per_second)
    : bus_(bus), bytes_per_step_(bytes_per_second * static_cast<double>(kStep) * 1e-6) {
  bus_.every(kStep, [this, alive = std::weak_ptr(alive_)] {
    if (!alive.expired()) send_some();
  });
}

void PacedQueue::push(std::string channel, Bytes bytes) { queue_.emplace_back(std::move(channel), std::move(bytes)); }

void PacedQueue::send_some() {
  budget_ = std::min(budget_ + bytes_per_step_, bytes_per_step_);
  while (!queue_.empty() && budget_ > 0) {
    const auto& [channel, bytes] = queue_.front();
    bus_.publish(channel, bytes);
    budget_ -= static_cast<double>(bytes.size());
    queue_.pop_front();
  }
}

}  // namespace concord
