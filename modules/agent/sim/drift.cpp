#include "agent/sim/drift.hpp"

#include <cmath>

namespace concord {
namespace {

double yaw_deviation(AgentKind kind) { return kind == AgentKind::kLidar ? 0.0001 : 0.0002; }
double shift_deviation(AgentKind kind) { return kind == AgentKind::kLidar ? 0.001 : 0.002; }

}  // namespace

Drift::Drift(AgentKind kind, std::uint64_t seed)
    : yaw_per_metre_(yaw_deviation(kind)),
      shift_per_metre_(shift_deviation(kind)),
      T_agent_map_(start_pose(kind).inverse()),
      random_(seed) {}

Transform Drift::believe(const Transform& T_map_base) {
  const Transform T_agent_base = T_agent_map_ * T_map_base;
  const Eigen::Vector3d here = T_agent_base.translation();
  if (last_) {
    const double root = std::sqrt((here - *last_).norm());
    const double yaw = yaw_per_metre_ * root * random_.normal();
    const Eigen::Vector3d shift = shift_per_metre_ * root * Eigen::Vector3d(random_.normal(), random_.normal(), 0);
    const Eigen::Vector3d believed = error_ * here;
    error_ = Eigen::Translation3d(believed + shift) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
             Eigen::Translation3d(-believed) * error_;
  }
  last_ = here;
  return error_ * T_agent_base;
}

}  // namespace concord
