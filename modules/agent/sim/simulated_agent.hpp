#pragma once

#include <cstdint>
#include <optional>

#include "agent/sim/drift.hpp"
#include "agent/sim/sensors.hpp"

namespace concord {

/// One moment of a simulated agent: what it measured and where it believed to be.
struct Moment {
  double time = 0;  ///< seconds from its start
  Transform T_map_base = Transform::Identity();
  Transform T_agent_base = Transform::Identity();    ///< as believed
  Transform T_agent_sensor = Transform::Identity();  ///< as believed
  std::vector<Eigen::Vector3f> points;               ///< agent frame, as believed
};

/// One agent on its whole way. The same world, kind and seed give the same moments.
class SimulatedAgent {
 public:
  /// `world` must outlive it.
  SimulatedAgent(const RayCaster& world, AgentKind kind, std::uint64_t seed);

  /// Nothing after the end of its way.
  [[nodiscard]] std::optional<Moment> next();

  /// Where it believes to be after it has gone on to there, at the end of its way.
  [[nodiscard]] Transform go_on(const Transform& T_map_base) { return drift_.believe(T_map_base); }

  /// Seconds from its start to the next moment.
  [[nodiscard]] double next_time() const { return scans_ / sensor_.scans_per_second; }
  [[nodiscard]] const Sensor& sensor() const { return sensor_; }
  [[nodiscard]] double duration() const { return trajectory_.duration(); }
  /// At the end of its way.
  [[nodiscard]] Transform last_pose() const { return trajectory_.T_map_base(trajectory_.duration()); }

 private:
  const RayCaster& world_;
  Trajectory trajectory_;
  Sensor sensor_;
  Drift drift_;
  Random random_;
  int scans_ = 0;
};

}  // namespace concord
