#include "bus/lockstep_bus.hpp"

#include <algorithm>

namespace concord {

void LockstepBus::subscribe(const std::string& channel_regex, Handler handler, int /*queued: nothing ever waits*/,
                            Owner owner) {
  subscriptions_.push_back({std::regex(channel_regex), std::move(handler), std::move(owner)});
  by_channel_.clear();
}

void LockstepBus::publish(const std::string& channel, std::span<const std::uint8_t> bytes) {
  queue_.push_back({channel, {bytes.begin(), bytes.end()}});
}

void LockstepBus::every(std::int64_t period, Task task, Owner owner) {
  timers_.push_back({period, now_ + period, std::move(task), std::move(owner)});
}

/// Not while a handler or task runs: it may be theirs.
void LockstepBus::forget_the_gone() {
  std::erase_if(timers_, [](const Timer& timer) { return timer.owner.expired(); });
  const auto gone = [](const Subscription& subscription) { return subscription.owner.expired(); };
  if (std::erase_if(subscriptions_, gone) > 0) by_channel_.clear();
}

const std::vector<LockstepBus::Subscription*>& LockstepBus::subscribers(const std::string& channel) {
  const auto it = by_channel_.find(channel);
  if (it != by_channel_.end()) return it->second;
  std::vector<Subscription*>& found = by_channel_[channel];
  for (Subscription& subscription : subscriptions_) {
    if (std::regex_match(channel, subscription.pattern)) found.push_back(&subscription);
  }
  return found;
}

void LockstepBus::deliver() {
  while (!queue_.empty()) {
    const Message message = std::move(queue_.front());
    queue_.pop_front();
    // By value: a handler may subscribe, which forgets the list.
    const std::vector<Subscription*> receivers = subscribers(message.channel);
    for (Subscription* receiver : receivers) {
      if (!receiver->owner.expired()) receiver->handler(message.channel, message.bytes);
    }
  }
}

void LockstepBus::advance_to(std::int64_t utime) {
  deliver();
  while (true) {
    forget_the_gone();
    const auto next =
        std::min_element(timers_.begin(), timers_.end(), [](const Timer& a, const Timer& b) { return a.due < b.due; });
    if (next == timers_.end() || next->due > utime) break;
    now_ = std::max(now_, next->due);
    next->due += next->period;
    next->task();
    deliver();
  }
  now_ = std::max(now_, utime);
}

}  // namespace concord
