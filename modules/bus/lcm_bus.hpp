#pragma once

#include <chrono>
#include <list>
#include <string>

#include <lcm/lcm-cpp.hpp>

#include "bus/bus.hpp"
#include "bus/counters.hpp"

namespace concord {

/// The bus over LCM. One thread: everything happens inside `spin_once`.
class LcmBus final : public Bus {
 public:
  /// `url` as LCM takes it, e.g. "udpm://239.255.76.67:7667?ttl=0" or "memq://".
  /// @throws ConfigError for a url that LCM cannot use (see check_lcm_url), and when it cannot join, with the usual
  /// cause.
  LcmBus(const std::string& url, Counters& counters);
  ~LcmBus() override;

  using Bus::every, Bus::subscribe;
  void subscribe(const std::string& channel_regex, Handler handler, int queued, Owner owner) override;
  void publish(const std::string& channel, std::span<const std::uint8_t> bytes) override;
  void every(std::int64_t period, Task task, Owner owner) override;
  /// The system's clock at the start, then as much later as has passed: a clock that is set while we run (NTP, a robot
  /// without a battery) neither stops timers nor makes time go back. @see Bus::now
  [[nodiscard]] std::int64_t now() const override;

  /// Waits up to `timeout_ms` (less when a timer is due) for messages, handles all that are there, runs due timers.
  void spin_once(int timeout_ms);
  /// Readable when messages are there: for who waits for other things too.
  [[nodiscard]] int descriptor() { return lcm_.getFileno(); }

 private:
  struct Subscription {
    LcmBus* bus;
    Handler handler;
    Owner owner;
    lcm::Subscription* raw = nullptr;
    void receive(const lcm::ReceiveBuffer* buffer, const std::string& channel);
  };
  struct Timer {
    std::int64_t period;
    std::int64_t due;
    Task task;
    Owner owner;
  };

  void forget_the_gone();
  void run_due_timers();
  void guarded(const std::string& what, const Task& task);

  lcm::LCM lcm_;
  std::int64_t start_;
  std::chrono::steady_clock::time_point steady_start_;
  Counters& counters_;
  std::list<Subscription> subscriptions_;
  std::list<Timer> timers_;
};

}  // namespace concord
