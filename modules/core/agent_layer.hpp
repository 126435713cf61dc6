#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "core/brick_map.hpp"
#include "core/transform.hpp"

namespace concord {

/// One agent's submap as those keep it who look at single agents, and where it lies.
struct AgentLayer {
  std::string frame_id;
  BrickMap map;
  std::int64_t revision = 0;
  bool synced = false;  ///< all that its stream has announced has arrived
  int weight = 1;
  std::optional<Transform> T_map_agent;
};
/// By agent.
using AgentLayers = std::map<std::string, AgentLayer>;

}  // namespace concord
