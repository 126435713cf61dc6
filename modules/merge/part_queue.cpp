#include "merge/part_queue.hpp"

namespace concord {
namespace {

constexpr std::int64_t kStep = 5'000;

}  // namespace

PartQueue::PartQueue(Bus& bus, double bytes_per_second) : bus_(bus), bytes_per_second_(bytes_per_second) {
  bus_.pace().join(alive_, [this] { return send_one(); });
  bus_.every(
      kStep, [this] { send_now(); }, alive_);
}

void PartQueue::send_now() {
  if (!queue_.empty()) bus_.pace().serve(bus_.now(), bytes_per_second_);
}

double PartQueue::send_one() {
  if (queue_.empty()) return 0;
  const Message message = std::move(queue_.front());
  queue_.pop_front();
  bus_.publish(message.channel, message.bytes);
  return static_cast<double>(message.bytes.size());
}

}  // namespace concord
