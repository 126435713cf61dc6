#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/brick_map.hpp"
#include "core/corrections.hpp"
#include "core/error.hpp"
#include "core/requests.hpp"

namespace concord {

/// What people mean who point into the map, be it in its frame or in an agent's.
class MapSelection {
 public:
  /// The map must outlive this.
  MapSelection(const BrickMap& map, double resolution) : map_(map), resolution_(resolution) {}

  /// Where the agents are from now on.
  void follow(const std::vector<AgentState>& agents);

  /// Refused: no such agent (kNoAgent), a frame that is over (kBadFrame), one that is not aligned (kNotAligned).
  [[nodiscard]] Result<Transform> T_map_frame(const WorkFrame& frame) const;
  /// What is occupied now of what a shape takes; sorted and unique. Refused: as above, and by `select`.
  [[nodiscard]] Result<std::vector<VoxelIndex>> occupied(const Shape& shape, const WorkFrame& frame) const;
  /// The object in the middle of what a shape takes. Refused likewise; kEmpty: it takes nothing; by propose_object.
  [[nodiscard]] Result<std::vector<VoxelIndex>> touched(const Shape& shape, const WorkFrame& frame) const;

 private:
  const BrickMap& map_;
  double resolution_;
  std::map<std::string, AgentState> agents_;
};

}  // namespace concord
