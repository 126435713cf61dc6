#include "align/dropped_offers.hpp"

#include <algorithm>
#include <cassert>

#include "align/drift_watch.hpp"

namespace concord {

void DroppedOffers::add(const std::string& id, const Place& place, const Alignment& said) {
  const bool is_correction = said.accepted();
  std::erase_if(dropped_, [&](const Dropped& one) {
    return one.place.agent == place.agent && one.is_correction == is_correction;
  });
  dropped_.push_back({id, place, is_correction, said.T_target_source, said.against_upright});
  if (dropped_.size() > kMaxKept) dropped_.erase(dropped_.begin());
}

bool DroppedOffers::contains(const std::string& id) const {
  return std::ranges::any_of(dropped_, [&](const Dropped& one) { return one.id == id; });
}

bool DroppedOffers::covers(const AlignTask& task, const Alignment& said) const {
  assert(task.is_recheck && task.T_target_source);
  return std::ranges::any_of(dropped_, [&](const Dropped& one) {
    const bool is_there = one.place.agent == task.used_source.agent &&
                          one.place.frame_id == task.used_source.frame_id &&
                          one.place.T_map_agent.isApprox(*task.T_target_source, 1e-9);
    if (!is_there || one.is_correction != said.accepted()) return false;
    if (!one.is_correction) return said.against_upright <= one.against + kMoreAgainst;
    return !slip_between(one.T_map_agent, said.T_target_source, task.p_source_middle).is_large(task.site.resolution);
  });
}

/// Who is gone, or in no map for a moment, may come back as it was.
void DroppedOffers::heed(const AgentLayers& layers) {
  std::erase_if(dropped_, [&](const Dropped& one) {
    const auto it = layers.find(one.place.agent);
    return it != layers.end() && it->second.T_map_agent && !lies_at(one.place, layers);
  });
}

}  // namespace concord
