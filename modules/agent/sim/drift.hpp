#pragma once

#include <cstdint>

#include "agent/sim/random.hpp"
#include "agent/sim/trajectory.hpp"

namespace concord {

/// What an agent believes of its way: its odometry errs a little in heading and place with each metre, and never
/// recovers. A few centimetres over a whole route; a LiDAR's is the best.
class Drift {
 public:
  Drift(AgentKind kind, std::uint64_t seed);

  /// The believed T_agent_base for the next true T_map_base; the first one is believed exactly.
  [[nodiscard]] Transform believe(const Transform& T_map_base);

 private:
  double yaw_per_metre_, shift_per_metre_;  ///< deviations after one metre; they grow with its square root
  Transform T_agent_map_;
  Transform error_ = Transform::Identity();  ///< believed = error_ * true, agent frame
  std::optional<Eigen::Vector3d> last_;
  Random random_;
};

}  // namespace concord
