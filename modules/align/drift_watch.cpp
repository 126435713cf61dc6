#include "align/drift_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace concord {
namespace {

constexpr double kSlipMetres = 0.1;
constexpr double kSlipVoxels = 2.0;
constexpr double kSlipRadians = 1.5 * M_PI / 180.0;  // half as much again as alignment itself may be off

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
    if (chosen != nullptr && when >= oldest) continue;
    if (it != seen_.end() && is_as_it_was(it->second.look, layers)) continue;
    chosen = &agent;
    oldest = when;
  }
  return chosen != nullptr ? std::optional(*chosen) : std::nullopt;
}

bool DriftWatch::is_as_it_was(const Look& look, const AgentLayers& layers) {
  const auto aligned =
      std::ranges::count_if(layers, [](const auto& entry) { return entry.second.T_map_agent.has_value(); });
  return layers.at(look.agent).revision == look.revision && std::cmp_equal(aligned, look.places.size()) &&
         std::ranges::all_of(look.places, [&](const Place& place) { return lies_at(place, layers); });
}

DriftWatch::Look DriftWatch::begin(const std::string& agent, const AgentLayers& layers) {
  return {agent, layers.at(agent).revision, places_of(layers)};
}

void DriftWatch::looked_at(Look look, std::int64_t took, std::int64_t now) {
  std::erase_if(seen_, [&](const auto& entry) { return !std::ranges::count(look.places, entry.first, &Place::agent); });
  const std::string agent = look.agent;
  seen_[agent] = {std::move(look), now};
  const double pause = static_cast<double>(took) * (1.0 / kShare - 1.0);
  not_before_ = now + std::max(kLeastPause, static_cast<std::int64_t>(pause));
}

void DriftWatch::forget(const std::string& agent) { seen_.erase(agent); }

bool Slip::is_large(double resolution) const {
  return metres > std::max(kSlipMetres, kSlipVoxels * resolution) || radians > kSlipRadians;
}

Slip slip_between(const Transform& T_map_agent, const Transform& found, const Eigen::Vector3d& p_agent) {
  const Eigen::Matrix3d turn = T_map_agent.linear().transpose() * found.linear();
  return {(T_map_agent * p_agent - found * p_agent).norm(), Eigen::AngleAxisd(turn).angle()};
}

}  // namespace concord
