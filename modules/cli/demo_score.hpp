#pragma once

#include <optional>
#include <vector>

#include "agent/sim/score.hpp"
#include "core/brick_map.hpp"
#include "core/transform.hpp"

namespace concord {

/// How far a demo's mapping had come.
struct MappingMoment {
  double seconds = 0.0;        ///< simulated, since the agents set out, of whoever is on its way the longest
  double robot_seconds = 0.0;  ///< of the first robot: it stands when its way is over
  BrickMap merged;             ///< occupied voxels only, as in `robot`
  BrickMap robot;              ///< of the first robot alone, its own frame
};

/// The occupied voxels of a map.
[[nodiscard]] BrickMap occupied_part(const BrickMap& map);

/// Measures maps of the simulated warehouse against it.
class DemoScorer {
 public:
  DemoScorer(const World& world, double resolution, Transform T_map_robot);

  [[nodiscard]] MapScore merged(const BrickMap& map) const { return score(map, truth_); }
  /// Of a submap in its own frame, put where its agent is known to be.
  [[nodiscard]] MapScore alone(const BrickMap& submap, const Transform& T_map_agent) const;
  [[nodiscard]] MapScore robot(const BrickMap& submap) const { return alone(submap, T_map_robot_); }

  /// Simulated seconds until the merged map, or the robot's own, showed this share of the surface; absent where none
  /// of the moments does. @pre moments are in order of time: what was shown is taken to stay shown.
  [[nodiscard]] std::optional<double> merged_reached(const std::vector<MappingMoment>& moments, double recall) const;
  [[nodiscard]] std::optional<double> robot_reached(const std::vector<MappingMoment>& moments, double recall) const;

 private:
  double resolution_;
  Transform T_map_robot_;
  Truth truth_;
};

}  // namespace concord
