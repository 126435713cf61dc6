#pragma once

#include <optional>
#include <set>

#include "agent/cloud_publisher.hpp"
#include "agent/sim/path_follower.hpp"
#include "agent/sim/simulated_agent.hpp"
#include "agent/submap_publisher.hpp"
#include "bus/process.hpp"

namespace concord {

/// One simulated agent on the bus. LiDAR robot and headset map themselves and send their submap; the depth camera sends
/// clouds. At the end of its way a robot follows the path that the planner keeps for it, at the site's speed for it. A
/// reset carries the agent back to where it started, where it begins anew in a new frame.
class SimNode {
 public:
  struct Config {
    std::string agent = "robot1";
    AgentKind kind = AgentKind::kLidar;
    std::uint64_t seed = 1;  ///< the warehouse's, the same for all agents; each draws its own noise from it
    double speed = 1;        ///< simulated seconds in a second, as far as the processor can follow
    bool leave = false;      ///< ends the process some seconds after the end of the way
  };

  SimNode(const NodeContext& context, const Config& config);

 private:
  void begin();
  void step();
  void take(const Moment& moment);
  void map(const Moment& moment);
  void drive();
  void publish_changes();
  void report();
  [[nodiscard]] bool all_sent() const;
  void leave_when_all_is_sent();

  Bus& bus_;
  Counters& counters_;
  Config config_;
  double resolution_;
  std::int64_t boot_id_;
  RayCaster world_;

  std::optional<SimulatedAgent> self_;
  std::int64_t began_ = 0;  ///< utime of the start of its way
  int frames_ = 0;
  std::int64_t scans_ = 0;
  BrickMap submap_;
  std::set<BrickIndex> changed_;          ///< since they were published last
  std::int64_t idle_since_ = 0;           ///< 0: not idle
  AgentConfig robot_;                     ///< as the site has it
  std::optional<PathFollower> follower_;  ///< of a robot at the end of its way

  std::optional<SubmapPublisher> submap_out_;
  std::optional<CloudPublisher> cloud_out_;
};

}  // namespace concord
