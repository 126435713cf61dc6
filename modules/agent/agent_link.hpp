#pragma once

#include <functional>
#include <string>

#include "agent/submap_publisher.hpp"
#include "bus/lcm_bus.hpp"

namespace concord {

/// A robot's whole connection to the stack, for programs that have no LCM loop of their own. One thread.
class AgentLink {
 public:
  /// `lcm_url`, `resolution` and `bytes_per_second` (the pace of the stream) are the site's.
  /// @throws ConfigError when LCM cannot join.
  AgentLink(const std::string& lcm_url, const std::string& agent, double resolution, std::function<void()> on_reset,
            double bytes_per_second = 5e6)
      : bus_(lcm_url, counters_),
        submap_(bus_, counters_, {agent, resolution, bytes_per_second, bus_.now()}, std::move(on_reset)) {}

  [[nodiscard]] SubmapPublisher& submap() { return submap_; }

  /// Sends what the pace allows, answers requests for repair. Call it all the time: at least every 50 ms.
  void spin_once(int timeout_ms) { bus_.spin_once(timeout_ms); }

  /// Microseconds since 1970: the clock that stamps belong to.
  [[nodiscard]] std::int64_t now() const { return bus_.now(); }

 private:
  Counters counters_;
  LcmBus bus_;
  SubmapPublisher submap_;
};

}  // namespace concord
