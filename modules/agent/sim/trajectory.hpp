#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/transform.hpp"

namespace concord {

enum class AgentKind { kLidar, kCamera, kHeadset };

/// "lidar", "camera" or "headset".
[[nodiscard]] std::optional<AgentKind> agent_kind(std::string_view name);

/// T_map_agent: an agent's frame is where it starts, level, on the floor (robots) or at eye height (headset).
[[nodiscard]] Transform start_pose(AgentKind kind);

/// The true way of one agent through the warehouse: each goes its own, and they overlap. Time in seconds from its
/// start.
class Trajectory {
 public:
  explicit Trajectory(AgentKind kind);

  [[nodiscard]] double duration() const { return keys_.back().time; }
  /// A robot's base is on the floor; a headset's is the head. x forward, z up.
  [[nodiscard]] Transform T_map_base(double time) const;
  /// x along the line of sight, z up.
  [[nodiscard]] Transform T_map_sensor(double time) const;

 private:
  struct Key {
    double time, x, y, yaw;
  };

  [[nodiscard]] Key at(double time) const;

  AgentKind kind_;
  std::vector<Key> keys_;  ///< straight drives and turns on the spot between them
};

}  // namespace concord
