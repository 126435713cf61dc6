#pragma once

#include <functional>
#include <memory>
#include <string>

#include "bus/bus.hpp"
#include "bus/counters.hpp"

namespace concord {

/// Hears on `out/frame_over/AGENT` that ingest takes nothing more of the robot's present frame, because a person gave
/// up its submap, and tells the robot, once per frame: it must begin a new one. Ingest repeats it as long as the robot
/// sends in that frame, so that no lost message and no robot that was switched off leaves it unheard.
class ResetListener {
 public:
  ResetListener(Bus& bus, Counters& counters, const std::string& agent, std::function<void()> on_reset);
  ResetListener(const ResetListener&) = delete;
  ResetListener& operator=(const ResetListener&) = delete;

  /// The frame that the robot sends in from now on.
  void begin_frame(const std::string& frame_id) { state_->frame_id = frame_id; }

 private:
  struct State {
    std::function<void()> on_reset;
    std::string frame_id;  ///< empty: none has begun, or the robot was told that it is over
  };
  std::shared_ptr<State> state_;  ///< the bus keeps subscriptions for good; they end with this
};

}  // namespace concord
