#include "align/align_task.hpp"

#include <cassert>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "core/compose.hpp"
#include "core/resample.hpp"

namespace concord {
namespace {

constexpr std::uint64_t kMaxBricks = 8'000'000;
constexpr double kContradicts = 0.25;
/// A map that is too fine or too large to be aligned as it is, is aligned in voxels of this.
constexpr double kCoarser[] = {0.05, 0.1, 0.2, 0.4};

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

Result<AlignMap> prepared(const BrickMap& map, double resolution, int threads) {
  auto out = make_align_map(map, resolution, threads);
  for (const double coarser : kCoarser) {
    const bool is_too_fine = !out && (out.error().code == Code::kTooLarge || out.error().code == Code::kBadResolution);
    if (!is_too_fine) break;
    if (coarser <= resolution) continue;
    const auto coarse = resample(map, resolution, coarser, kMaxBricks);
    if (!coarse) return tl::unexpected(coarse.error());
    out = make_align_map(*coarse, coarser, threads);
  }
  return out;
}

Result<AlignMap> prepared_target(const AlignTask& task, int threads) {
  if (task.target.size() == 1 && task.target[0].T_target_part.matrix().isIdentity(0.0)) {
    return prepared(task.target[0].map, task.site.resolution, threads);
  }
  std::vector<Layer> layers;
  for (const AlignTask::Part& part : task.target) layers.push_back({&part.map, part.T_target_part, part.weight});
  const MergedMap merged = compose(layers, {}, task.site.policy, task.site.resolution, threads);
  return prepared(merged.values, task.site.resolution, threads);
}

}  // namespace

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
  return !alignment.accepted() && alignment.against_upright >= kContradicts;
}

Result<Alignment> carry_out(const AlignTask& task, int threads) {
  const auto source = prepared(task.source, task.site.resolution, threads);
  if (!source) return tl::unexpected(source.error());
  const auto target = prepared_target(task, threads);
  if (!target) return tl::unexpected(target.error());
  if (!task.is_recheck) return align(*target, *source, task.T_target_source, threads);
  assert(task.T_target_source);
  const Alignment near = recheck(*target, *source, *task.T_target_source, threads);
  if (near.accepted() || !contradicts(near)) return near;
  // It no longer lies where it was put, or within voxels of it: it is looked for as from a rough guess.
  const Alignment far = align(*target, *source, task.T_target_source, threads);
  return far.accepted() ? far : near;
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
