#include "merge/layered_map.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace concord {

void LayeredMap::begin_layer(const std::string& agent, const std::string& frame_id, int weight) {
  remove_layer(agent);
  AgentLayer& layer = layers_[agent];
  layer.frame_id = frame_id;
  layer.weight = weight;
}

void LayeredMap::set_brick(const std::string& agent, BrickIndex index, Brick brick) {
  const auto it = layers_.find(agent);
  assert(it != layers_.end());
  AgentLayer& layer = it->second;
  if (const Brick* before = layer.map.find(index)) {
    layer.known -= before->known_count();
    layer.occupied -= before->occupied_count();
  }
  layer.known += brick.known_count();
  layer.occupied += brick.occupied_count();
  if (layer.map.set(index, std::move(brick)) && layer.lattice) layer.lattice->touch(index, dirty_);
}

void LayeredMap::place(const std::string& agent, const Transform& T_map_agent) {
  const auto it = layers_.find(agent);
  assert(it != layers_.end());
  AgentLayer& layer = it->second;
  if (layer.T_map_agent && layer.T_map_agent->matrix() == T_map_agent.matrix()) return;
  mark(layer);
  layer.T_map_agent = T_map_agent;
  layer.lattice.emplace(T_map_agent, resolution_);
  mark(layer);
}

void LayeredMap::unplace(const std::string& agent) {
  const auto it = layers_.find(agent);
  assert(it != layers_.end());
  mark(it->second);
  it->second.T_map_agent.reset();
  it->second.lattice.reset();
}

void LayeredMap::remove_layer(const std::string& agent) {
  const auto it = layers_.find(agent);
  if (it == layers_.end()) return;
  mark(it->second);
  layers_.erase(it);
}

void LayeredMap::set_weight(const std::string& agent, int weight) {
  const auto it = layers_.find(agent);
  assert(it != layers_.end() && weight >= 1 && weight <= 1000);
  if (it->second.weight == weight) return;
  it->second.weight = weight;
  mark(it->second);
}

/// All that the layer contributes to, where it lies now.
void LayeredMap::mark(const AgentLayer& layer) {
  if (!layer.lattice) return;
  layer.map.for_each_brick([&](BrickIndex index, const Brick&) { layer.lattice->touch(index, dirty_); });
}

bool LayeredMap::fits(const std::string& agent, const Transform& T_map_agent) const {
  const AgentLayer* layer = find(agent);
  return layer == nullptr || concord::fits({&layer->map, T_map_agent, layer->weight}, resolution_);
}

LayeredMap::Changes LayeredMap::refold() {
  Changes changes;
  // In parts: what a large re-alignment folds to must not stand in memory all at once.
  constexpr std::size_t kTilesAtOnce = 256;
  const std::vector<BrickSet::Entry> tiles = std::exchange(dirty_, {}).sorted();
  for (std::size_t i = 0; i < tiles.size(); i += kTilesAtOnce) {
    BrickSet part;
    for (std::size_t k = i; k < std::min(i + kTilesAtOnce, tiles.size()); ++k)
      part.insert(tiles[k].tile, tiles[k].bricks);
    fold_into(part, changes);
  }
  return changes;
}

void LayeredMap::fold_into(const BrickSet& dirty, Changes& changes) {
  std::vector<Layer> aligned;
  for (const auto& [agent, layer] : layers_) {
    if (layer.T_map_agent) aligned.push_back({&layer.map, *layer.T_map_agent, layer.weight});
  }
  for (FoldedBrick& folded : fold(aligned, pins_, policy_, resolution_, dirty)) {
    if (merged_.values.set(folded.index, std::move(folded.values))) changes.map.push_back(folded.index);
    if (merged_.conflicts.set(folded.index, Brick::uniform(folded.conflicts, kOccupied))) {
      changes.conflicts.push_back(folded.index);
    }
  }
}

const LayeredMap::AgentLayer* LayeredMap::find(const std::string& agent) const {
  const auto it = layers_.find(agent);
  return it != layers_.end() ? &it->second : nullptr;
}

}  // namespace concord
