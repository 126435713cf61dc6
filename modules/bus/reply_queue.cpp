#include "bus/reply_queue.hpp"

#include <cassert>
#include <utility>

namespace concord {
namespace {

constexpr std::int64_t kStep = 5'000;

}  // namespace

ReplyQueue::ReplyQueue(Bus& bus, double bytes_per_second) : bus_(bus), bytes_per_second_(bytes_per_second) {
  bus_.pace().join(alive_, [this] { return send_one(); });
  bus_.every(
      kStep, [this] { send_now(); }, alive_);
}

void ReplyQueue::push(const std::string& request, std::string channel, Bytes bytes) {
  assert(has_room(1));
  queue_.push_back({request, std::move(channel), std::move(bytes)});
  ++waiting_[request];
}

void ReplyQueue::send_now() {
  if (!queue_.empty()) bus_.pace().serve(bus_.now(), bytes_per_second_);
}

/// Returns what it costs.
double ReplyQueue::send_one() {
  if (queue_.empty()) return 0;
  const Message message = std::move(queue_.front());
  queue_.pop_front();
  const auto waiting = waiting_.find(message.request);
  if (--waiting->second == 0) waiting_.erase(waiting);
  bus_.publish(message.channel, message.bytes);
  return static_cast<double>(message.bytes.size());
}

}  // namespace concord
