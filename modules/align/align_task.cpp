#include "align/align_task.hpp"

#include <cassert>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "align/drift_watch.hpp"
#include "align/prepare.hpp"
#include "align/workers.hpp"
#include "core/compose.hpp"

namespace concord {
namespace {

/// Rooms that lie right among each other in voxels have up to 4 % against them, those that slipped 7 % and more.
constexpr double kContradictedWalls = 0.05;
constexpr double kContradictedLevel = 0.15;
/// So much says that an agent lies wrong even where little is left that lies on the others.
constexpr double kContradictedAnyhow = 0.25;

Result<const AgentLayer*> layer_of(const std::string& agent, const std::string& frame_id, const AgentLayers& layers) {
  const auto it = layers.find(agent);
  if (it == layers.end() || it->second.frame_id.empty()) {
    return refuse(Code::kNoAgent, "no agent " + agent + " has sent a submap; see: concord agents");
  }
  if (!frame_id.empty() && frame_id != it->second.frame_id) {
    return refuse(Code::kBadFrame, agent + " is in frame " + it->second.frame_id + " now");
  }
  if (!it->second.synced) return refuse(Code::kBusy, "the submap of " + agent + " is not whole here; ask again");
  return &it->second;
}

AlignResult::Used used(const std::string& agent, const AgentLayer& layer) {
  return {agent, layer.frame_id, layer.revision};
}

void add_part(const std::string& agent, const AgentLayer& layer, BrickMap map, const Transform& T, AlignTask& task) {
  task.target.push_back({agent, std::move(map), T, layer.weight});
  task.used_layers.push_back(used(agent, layer));
}

AlignTask begin_task(const std::string& agent, const AgentLayer& layer, const AlignSite& site) {
  AlignTask task;
  task.site = site;
  task.used_source = used(agent, layer);
  return task;
}

Eigen::AlignedBox3d bounds_of(BrickIndex index, double resolution) {
  const Eigen::Vector3d low = Eigen::Vector3d(index.x, index.y, index.z) * kBrickSide * resolution;
  return {low, low + Eigen::Vector3d::Constant(kBrickSide * resolution)};
}

/// Of what is occupied, in the layer's frame.
Eigen::AlignedBox3d bounds_of(const BrickMap& map, double resolution) {
  Eigen::AlignedBox3d out;
  map.for_each_brick([&](BrickIndex index, const Brick& brick) {
    if (brick.occupied() != VoxelMask{}) out.extend(bounds_of(index, resolution));
  });
  return out;
}

/// The bricks of a layer that touch a box in the map's frame.
BrickMap cut(const AgentLayer& layer, const Transform& T_map_layer, const Eigen::AlignedBox3d& box, double resolution) {
  BrickMap out;
  if (box.isEmpty()) return out;
  const Eigen::AlignedBox3d near = box.transformed(T_map_layer.inverse());
  layer.map.for_each_brick([&](BrickIndex index, const Brick& brick) {
    if (near.intersects(bounds_of(index, resolution))) out.set(index, brick);
  });
  return out;
}

Result<AlignMap> prepared_target(const AlignTask& task, int threads) {
  if (task.target.size() == 1 && task.target[0].T_target_part.matrix().isIdentity(0.0)) {
    return prepare_map(task.target[0].map, task.site.resolution, threads);
  }
  std::vector<Layer> layers;
  for (const AlignTask::Part& part : task.target) layers.push_back({&part.map, part.T_target_part, part.weight});
  const MergedMap merged = compose(layers, {}, task.site.policy, task.site.resolution, threads, stop_in_scope());
  look_for_stop();
  return prepare_map(merged.values, task.site.resolution, threads);
}

/// Whether it may have slipped farther than refinement reaches.
bool may_have_slipped(const Alignment& near) {
  return near.reason == AlignReason::kDiverged ||
         (near.reason == AlignReason::kLowOverlap && near.against_upright >= kContradictedAnyhow);
}

Result<Alignment> found_of(const AlignTask& task, int threads) {
  const auto source = prepare_map(task.source, task.site.resolution, threads);
  if (!source) return tl::unexpected(source.error());
  const auto target = prepared_target(task, threads);
  if (!target) return tl::unexpected(target.error());
  if (!task.is_recheck) return align(*target, *source, task.T_target_source, threads);
  assert(task.T_target_source);
  const Alignment near = recheck(*target, *source, *task.T_target_source, threads);
  if (!may_have_slipped(near)) return near;
  const Alignment far = align(*target, *source, task.T_target_source, threads);
  // What is forgiven where a person said that it lies there is what the watch is to say.
  const bool slipped =
      far.accepted() &&
      slip_between(*task.T_target_source, far.T_target_source, task.p_source_middle).is_large(task.site.resolution);
  return slipped ? far : near;
}

}  // namespace

std::vector<Place> places_of(const AgentLayers& layers) {
  std::vector<Place> places;
  for (const auto& [agent, layer] : layers) {
    if (layer.T_map_agent) places.push_back({agent, layer.frame_id, *layer.T_map_agent});
  }
  return places;
}

bool lies_at(const Place& place, const AgentLayers& layers) {
  const auto it = layers.find(place.agent);
  return it != layers.end() && it->second.frame_id == place.frame_id && it->second.T_map_agent &&
         it->second.T_map_agent->isApprox(place.T_map_agent, 1e-9);
}

std::vector<Place> places_of(const AlignTask& task) {
  std::vector<Place> places;
  if (!task.target_agent.empty()) return places;
  for (std::size_t i = 0; i < task.target.size(); ++i) {
    places.push_back({task.target[i].agent, task.used_layers[i].frame_id, task.target[i].T_target_part});
  }
  if (task.is_recheck) places.push_back({task.used_source.agent, task.used_source.frame_id, *task.T_target_source});
  return places;
}

Result<void> check_task(const AlignRequest& request, const AgentLayers& layers) {
  if (request.source == request.target) return refuse(Code::kBadRequest, "an agent lies in itself where it lies");
  const auto source = layer_of(request.source, request.source_frame_id, layers);
  if (!source) return tl::unexpected(source.error());
  if (!request.target.empty()) {
    const auto target = layer_of(request.target, request.target_frame_id, layers);
    if (!target) return tl::unexpected(target.error());
    return {};
  }
  bool is_there = false;
  for (const auto& [agent, layer] : layers) {
    if (agent == request.source || !layer.T_map_agent) continue;
    if (!layer.synced) return refuse(Code::kBusy, "the submap of " + agent + " is not whole here; ask again");
    is_there = true;
  }
  if (is_there) return {};
  return refuse(Code::kNoMap, "nobody but " + request.source + " is in the map; name an agent to align it to");
}

Result<AlignTask> make_task(const AlignRequest& request, const AgentLayers& layers, const AlignSite& site) {
  if (const auto can = check_task(request, layers); !can) return tl::unexpected(can.error());
  const AgentLayer& source = layers.at(request.source);
  AlignTask task = begin_task(request.source, source, site);
  task.id = request.id;
  task.target_agent = request.target;
  task.T_target_source = request.T_target_source;
  task.source = source.map;
  if (!request.target.empty()) {
    const AgentLayer& target = layers.at(request.target);
    add_part(request.target, target, target.map, Transform::Identity(), task);
    return task;
  }
  for (const auto& [agent, layer] : layers) {
    if (agent == request.source || !layer.T_map_agent) continue;
    add_part(agent, layer, layer.map, *layer.T_map_agent, task);
  }
  return task;
}

Result<AlignTask> make_recheck(const std::string& agent, const AgentLayers& layers, const AlignSite& site) {
  const auto found = layer_of(agent, "", layers);
  if (!found) return tl::unexpected(found.error());
  const AgentLayer& source = **found;
  if (!source.T_map_agent) return refuse(Code::kNotAligned, agent + " is not aligned");
  const Transform& T = *source.T_map_agent;
  AlignTask task = begin_task(agent, source, site);
  task.T_target_source = T;
  task.is_recheck = true;
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(kRecheckMargin);
  const Eigen::AlignedBox3d surface = bounds_of(source.map, site.resolution);
  if (surface.isEmpty()) return refuse(Code::kNoMap, agent + " has no surface yet");
  const Eigen::AlignedBox3d there = surface.transformed(T);
  const Eigen::AlignedBox3d near{there.min() - margin, there.max() + margin};
  Eigen::AlignedBox3d others;
  for (const auto& [id, layer] : layers) {
    if (id == agent || !layer.T_map_agent || !layer.synced) continue;
    BrickMap part = cut(layer, *layer.T_map_agent, near, site.resolution);
    if (part.empty()) continue;
    const Eigen::AlignedBox3d of_part = bounds_of(part, site.resolution);
    if (!of_part.isEmpty()) others.extend(of_part.transformed(*layer.T_map_agent));
    add_part(id, layer, std::move(part), *layer.T_map_agent, task);
  }
  if (task.target.empty()) return refuse(Code::kNoMap, "nobody else is in the map near " + agent);
  task.source = cut(source, T, {others.min() - margin, others.max() + margin}, site.resolution);
  const Eigen::AlignedBox3d compared = bounds_of(task.source, site.resolution);
  if (compared.isEmpty()) return refuse(Code::kNoMap, agent + " has no surface near the others");
  task.p_source_middle = compared.center();
  return task;
}

bool contradicts(const Alignment& alignment) {
  return may_have_slipped(alignment) &&
         (alignment.against_upright >= kContradictedWalls || alignment.against_level >= kContradictedLevel);
}

Result<Alignment> carry_out(const AlignTask& task, int threads, std::stop_token stop) {
  const StopScope scope(std::move(stop));
  try {
    return found_of(task, threads);
  } catch (const Stopped& stopped) {
    return refuse(Code::kExpired, stopped.what());
  }
}

AlignResult result_of(const AlignTask& task, Alignment alignment, std::int64_t utime) {
  AlignResult out;
  out.id = task.id;
  out.target = task.target_agent;
  out.source = task.used_source;
  out.layers = task.used_layers;
  out.evidence = std::move(alignment);
  out.utime = utime;
  return out;
}

}  // namespace concord
