#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "agent/reset_listener.hpp"
#include "bus/brick_stream.hpp"
#include "core/brick_map.hpp"
#include "core/transform.hpp"

namespace concord {

/// What a robot or headset says to the stack: its submap, of which only what changed travels, and its pose.
/// A robot with an event loop of its own runs a Bus in it; one without takes an AgentLink (agent_link.hpp).
class SubmapPublisher {
 public:
  struct Config {
    std::string agent;              ///< its id in the site file: is_name()
    double resolution = 0.05;       ///< metres; the site's
    double bytes_per_second = 5e6;  ///< pace of the stream
    std::int64_t boot_id = 0;       ///< must be greater than that of every earlier start: take Bus::now()
  };

  /// `on_reset` is called when a person gave up this agent's submap and ingest dropped it, at the latest with the
  /// first that is sent after it: start mapping anew, then call begin_frame.
  SubmapPublisher(Bus& bus, Counters& counters, Config config, std::function<void()> on_reset);

  /// A new frame, at the start and whenever the robot's SLAM begins anew: what was published is void.
  /// The same id after a restart says that the submap goes on where it was. @pre is_name(frame_id).
  void begin_frame(const std::string& frame_id);

  /// The robot's whole submap as it is now, agent frame. What is as it was is not sent again.
  /// Costs a comparison of all bricks. Returns the number of bricks that changed. @pre begin_frame was called.
  std::size_t publish(const BrickMap& submap);
  /// One brick as it is now (empty: gone), for robots that know what they changed. Returns whether it differs.
  /// @pre begin_frame was called.
  bool publish_brick(BrickIndex index, Brick brick);

  /// Where the robot's base is in its own frame, at `utime` (microseconds since 1970). @pre begin_frame was called.
  void publish_pose(const Transform& T_agent_base, std::int64_t utime);

  /// Everything published was sent at least once. Repairs may still be asked for: keep the bus running.
  [[nodiscard]] bool idle() const { return sender_.idle(); }
  [[nodiscard]] std::int64_t bytes_sent() const { return sender_.bytes_sent(); }
  /// What was published last.
  [[nodiscard]] const BrickMap& submap() const { return submap_; }

 private:
  Bus& bus_;
  std::string agent_;
  std::string frame_id_;
  BrickMap submap_;  ///< as published: what changes are found against and repairs are made from
  BrickSender sender_;
  ResetListener reset_listener_;
};

}  // namespace concord
