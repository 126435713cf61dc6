#include "cli/demo_scene.hpp"

#include <algorithm>

#include "agent/sim/trajectory.hpp"
#include "cli/arguments.hpp"
#include "cli/live.hpp"
#include "cli/map_file.hpp"

namespace concord {
namespace {

Result<std::vector<VoxelIndex>> voxels_in(const Box& box, double resolution) {
  return select(box, Transform::Identity(), resolution, kMaxEditVoxels);
}

Result<void> add_maps(const DemoOptions& options, DemoScene& scene) {
  const auto T_a_b = parse_transform(options.transform);
  if (!T_a_b) return tl::unexpected(T_a_b.error());
  auto a = load_map(options.maps[0]);
  if (!a) return tl::unexpected(a.error());
  auto b = load_map(options.maps[1], a->resolution);
  if (!b) return tl::unexpected(b.error());
  scene.resolution = a->resolution;
  scene.agents.push_back({"a", "map", 1, Transform::Identity(), std::move(a->map)});
  scene.agents.push_back({"b", "map", 1, *T_a_b, std::move(b->map)});
  for (const DemoAgent& agent : scene.agents) {
    if (agent.file->empty()) return refuse(Code::kEmpty, options.maps[agent.id == "b" ? 1 : 0] + " holds no voxel");
  }
  return {};
}

Result<void> add_warehouse(const DemoOptions& options, DemoScene& scene) {
  scene.world = make_warehouse(options.seed);
  const auto add = [&](const char* id, const char* name, AgentKind kind, int weight) {
    scene.agents.push_back({id, name, weight, start_pose(kind), std::nullopt, Trajectory(kind).duration()});
  };
  add("robot1", "lidar", AgentKind::kLidar, 3);
  add("cart1", "camera", AgentKind::kCamera, 1);
  add("headset1", "headset", AgentKind::kHeadset, 2);
  scene.start = scene.world->through_glass.from;
  scene.goal = scene.world->through_glass.to;
  // What no sensor returns, but a person sees.
  std::vector<VoxelIndex> voxels;
  for (const Feature& feature : scene.world->features) {
    if (!feature.edit_box || (feature.name != "glass" && feature.name != "reflective plate")) continue;
    const auto part = voxels_in({feature.edit_box->min(), feature.edit_box->max()}, scene.resolution);
    if (!part) return tl::unexpected(part.error());
    voxels.insert(voxels.end(), part->begin(), part->end());
  }
  std::ranges::sort(voxels);
  scene.edit = std::move(voxels);
  return {};
}

Result<void> add_wishes(const DemoOptions& options, DemoScene& scene) {
  if (options.from.empty() != options.to.empty()) return refuse(Code::kBadRequest, "--from and --to go together");
  if (!options.from.empty()) {
    const auto from = parse_point(options.from), to = parse_point(options.to);
    if (!from) return tl::unexpected(from.error());
    if (!to) return tl::unexpected(to.error());
    scene.start = *from;
    scene.goal = *to;
  }
  if (options.edit_box.empty()) return {};
  return parse_box(options.edit_box)
      .and_then([&](const Box& box) { return voxels_in(box, scene.resolution); })
      .map([&](std::vector<VoxelIndex> voxels) { scene.edit = std::move(voxels); });
}

}  // namespace

Result<DemoScene> make_scene(const DemoOptions& options, const Site& site) {
  DemoScene scene;
  scene.resolution = site.resolution;
  scene.zmin = options.band.empty() ? site.planner.zmin : options.band[0];
  scene.zmax = options.band.empty() ? site.planner.zmax : options.band[1];
  const Result<void> added = options.maps.empty() ? add_warehouse(options, scene) : add_maps(options, scene);
  if (!added) return tl::unexpected(added.error());
  if (const Result<void> wished = add_wishes(options, scene); !wished) return tl::unexpected(wished.error());
  return scene;
}

Site demo_site(const DemoScene& scene, Site site, const std::filesystem::path& state) {
  site.state = std::filesystem::absolute(state);
  site.resolution = scene.resolution;
  site.planner.zmin = scene.zmin;
  site.planner.zmax = scene.zmax;
  site.bridge = {};
  site.bridge.port = 0;  // wherever there is room
  site.bridge.local_role = "robot";
  for (const DemoAgent& agent : scene.agents) {
    AgentConfig config = site.unlisted;
    config.kind = agent.kind;
    config.weight = agent.weight;
    site.agents.try_emplace(agent.id, config);
  }
  return site;
}

}  // namespace concord
