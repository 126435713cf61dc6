#pragma once

#include <vector>

#include "agent/sim/random.hpp"
#include "agent/sim/ray_caster.hpp"
#include "agent/sim/trajectory.hpp"

namespace concord {

/// A range sensor: one ray per direction, x along the line of sight, z up. Metres.
struct Sensor {
  std::vector<Eigen::Vector3d> directions;  ///< unit, sensor frame
  double min_range = 0;
  double max_range = 0;      ///< beyond it nothing returns
  double trusted_range = 0;  ///< beyond it a return only says that the way up to here is free
  double noise = 0;          ///< deviation of a range, at no distance
  double noise_growth = 0;   ///< and what the square of the range adds to it, 1/m
  double black_range = 0;    ///< beyond it black returns nothing
  double black_return = 0;   ///< share of the rays that come back from black within it
  double scans_per_second = 0;
};

/// LiDAR: 32 rings within 15 degrees of level, 25 m. Depth camera: 80 x 60 rays over 87 x 58 degrees, to 5 m, noise
/// growing with the range. Headset: 96 x 72 rays over 80 x 64 degrees, to 3.5 m, smoothed as a mesh is.
[[nodiscard]] Sensor make_sensor(AgentKind kind);

/// What comes back, in the sensor's frame. Glass lets light through, a mirror sends it elsewhere, black swallows most.
[[nodiscard]] std::vector<Eigen::Vector3d> measure(const Sensor& sensor, const RayCaster& world,
                                                   const Transform& T_map_sensor, Random& random);

}  // namespace concord
