#pragma once

#include <cstdint>
#include <deque>
#include <list>
#include <map>
#include <regex>
#include <string>

#include "bus/bus.hpp"

namespace concord {

/// A bus within one process on a clock that stands still until it is told: nodes on it do the same thing for the same
/// input, every time. Messages are delivered in the order of publishing, timers in the order of their due time.
class LockstepBus final : public Bus {
 public:
  explicit LockstepBus(std::int64_t start) : now_(start) {}

  using Bus::every, Bus::subscribe;
  void subscribe(const std::string& channel_regex, Handler handler, int queued, Owner owner) override;
  void publish(const std::string& channel, std::span<const std::uint8_t> bytes) override;
  void every(std::int64_t period, Task task, Owner owner) override;
  [[nodiscard]] std::int64_t now() const override { return now_; }

  /// Runs all timers up to `utime`, and after each whatever was published; then the clock shows `utime`.
  void advance_to(std::int64_t utime);
  /// Delivers until nothing is queued.
  void deliver();

 private:
  struct Subscription {
    std::regex pattern;
    Handler handler;
    Owner owner;
  };
  struct Timer {
    std::int64_t period;
    std::int64_t due;
    Task task;
    Owner owner;
  };
  struct Message {
    std::string channel;
    std::vector<std::uint8_t> bytes;
  };

  void forget_the_gone();
  const std::vector<Subscription*>& subscribers(const std::string& channel);

  std::int64_t now_;
  std::list<Subscription> subscriptions_;
  std::map<std::string, std::vector<Subscription*>> by_channel_;  ///< forgotten at each change of them
  std::list<Timer> timers_;
  std::deque<Message> queue_;
};

}  // namespace concord
