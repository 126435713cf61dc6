#include "align/drift_watch.hpp"

#include <algorithm>
#include <cmath>

namespace concord {
namespace {

constexpr double kSlipMetres = 0.1;
constexpr double kSlipVoxels = 2.0;
constexpr double kSlipRadians = M_PI / 180.0;

}  // namespace

std::optional<std::string> DriftWatch::next(const AgentLayers& layers, std::int64_t now) const {
  if (now < not_before_) return std::nullopt;
  const auto aligned =
      std::ranges::count_if(layers, [](const auto& entry) { return entry.second.T_map_agent.has_value(); });
  if (aligned < 2) return std::nullopt;
  const std::string* chosen = nullptr;
  std::int64_t oldest = 0;
  for (const auto& [agent, layer] : layers) {
    if (!layer.T_map_agent || !layer.synced) continue;
    const auto it = seen_.find(agent);
    const std::int64_t when = it != seen_.end() ? it->second.when : 0;
    const bool is_as_it_was = it != seen_.end() && it->second.frame_id == layer.frame_id &&
                              it->second.revision == layer.revision &&
                              it->second.T_map_agent.matrix() == layer.T_map_agent->matrix();
    if (is_as_it_was || (chosen != nullptr && when >= oldest)) continue;
    chosen = &agent;
    oldest = when;
  }
  return chosen != nullptr ? std::optional(*chosen) : std::nullopt;
}

void DriftWatch::looked_at(const std::string& agent, const AgentLayers& layers, std::int64_t took, std::int64_t now) {
  const auto it = layers.find(agent);
  if (it == layers.end() || !it->second.T_map_agent) {
    seen_.erase(agent);
  } else {
    seen_[agent] = {it->second.frame_id, it->second.revision, *it->second.T_map_agent, now};
  }
  std::erase_if(seen_, [&](const auto& entry) { return !layers.contains(entry.first); });
  const double pause = static_cast<double>(took) * (1.0 / kShare - 1.0);
  not_before_ = now + std::max(kLeastPause, static_cast<std::int64_t>(pause));
}

bool Slip::is_large(double resolution) const {
  return metres > std::max(kSlipMetres, kSlipVoxels * resolution) || radians > kSlipRadians;
}

Slip slip_between(const Transform& T_map_agent, const Transform& found, const Eigen::Vector3d& p_agent) {
  const Eigen::Matrix3d turn = T_map_agent.linear().transpose() * found.linear();
  return {(T_map_agent * p_agent - found * p_agent).norm(), Eigen::AngleAxisd(turn).angle()};
}

}  // namespace concord
