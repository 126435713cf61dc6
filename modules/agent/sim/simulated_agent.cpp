#include "agent/sim/simulated_agent.hpp"

namespace concord {

SimulatedAgent::SimulatedAgent(const RayCaster& world, AgentKind kind, std::uint64_t seed)
    : world_(world), trajectory_(kind), sensor_(make_sensor(kind)), drift_(kind, seed), random_(~seed) {}

std::optional<Moment> SimulatedAgent::next() {
  Moment moment;
  moment.time = next_time();
  if (moment.time > trajectory_.duration()) return std::nullopt;
  ++scans_;

  moment.T_map_base = trajectory_.T_map_base(moment.time);
  moment.T_agent_base = drift_.believe(moment.T_map_base);
  const Transform T_map_sensor = trajectory_.T_map_sensor(moment.time);
  moment.T_agent_sensor = moment.T_agent_base * moment.T_map_base.inverse() * T_map_sensor;
  for (const Eigen::Vector3d& p_sensor : measure(sensor_, world_, T_map_sensor, random_)) {
    moment.points.push_back((moment.T_agent_sensor * p_sensor).cast<float>());
  }
  return moment;
}

}  // namespace concord
