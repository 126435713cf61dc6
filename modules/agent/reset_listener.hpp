#pragma once

#include <functional>
#include <memory>
#include <string>

#include "bus/bus.hpp"
#include "bus/counters.hpp"

namespace concord {

/// Hears on `in/agent_request` when a person gives up an agent's submap, and tells the robot, which must begin a new
/// frame: ingest takes nothing more of the present one. A request that is repeated (same id) is told once.
class ResetListener {
 public:
  ResetListener(Bus& bus, Counters& counters, const std::string& agent, std::function<void()> on_reset);
  ResetListener(const ResetListener&) = delete;
  ResetListener& operator=(const ResetListener&) = delete;

 private:
  struct State {
    std::string agent;
    std::function<void()> on_reset;
    std::string last_id;
  };
  std::shared_ptr<State> state_;  ///< the bus keeps subscriptions for good; they end with this
};

}  // namespace concord
