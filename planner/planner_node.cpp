#include "planner/planner_node.hpp"

#include <set>
#include <string>

namespace concord {
namespace {

constexpr std::int64_t kTick = 50'000;  ///< map changes are gathered for so long, microseconds

Grid make_grid(const Site& site) {
  const Result<Band> band = make_band(site.planner.zmin, site.planner.zmax, site.resolution);
  if (!band) throw ConfigError("planner: " + band.error().message);
  return {site.resolution, *band, site.planner.free_share};
}

}  // namespace

PlannerNode::PlannerNode(const NodeContext& context)
    : context_(context),
      planner_(make_grid(context.site)),
      sender_(context.bus, context.counters,
              {.stream = "out/grid",
               .resolution = context.site.resolution,
               .bytes_per_second = context.site.stream.bytes_per_second,
               .boot_id = context.boot_id},
              planner_.grid().cells()),
      receiver_(context.bus, context.counters, {.stream = "out/map", .resolution = context.site.resolution},
                {.on_frame = [this](const std::string& frame_id) { on_frame(frame_id); },
                 .on_brick = [this](BrickIndex index, Brick brick) { planner_.set_brick(index, std::move(brick)); },
                 .on_end = [this] { planner_.clear_map(); }}),
      zones_(context.bus, context.counters, "out/zones", [this](const std::vector<Zone>&) { on_zones(); }),
      label_zones_(context.bus, context.counters, "out/label_zones", [this](const std::vector<Zone>&) {
        if (zones_.synced()) on_zones();  // else they are still to come
      }) {
  Bus& bus = context_.bus;
  Counters& counters = context_.counters;
  const std::string& self = context_.process;
  listen<BrickPacket>(bus, counters, self, "out/map/bricks",
                      [this](const std::string&, const BrickPacket& packet) { receiver_.on_packet(packet); });
  listen<BrickDigest>(bus, counters, self, "out/map/digest",
                      [this](const std::string&, const BrickDigest& digest) { receiver_.on_digest(digest); });
  listen<MapPose>(bus, counters, self, "out/pose/.*", [this](const std::string& channel, const MapPose& pose) {
    if (!planner_.set_pose(pose.agent, pose.T_map_base.translation().head<2>())) {
      context_.counters.refused(channel, {Code::kTooLarge, "poses of more robots than are kept"});
    }
  });
  listen<AgentList>(bus, counters, self, "out/agents", [this](const std::string&, const AgentList& list) {
    std::set<std::string> aligned;
    for (const AgentState& agent : list.agents) {
      if (agent.aligned) aligned.insert(agent.id);
    }
    planner_.keep_poses(aligned);
  });
  listen<PathRequest>(bus, counters, self, "in/path_request",
                      [this](const std::string&, const PathRequest& request) { on_request(request); });
  bus.every(kTick, [this] {
    project();
    speak();
  });
}

/// What was known before is void: the grid empties, and its stream begins anew in the new frame.
void PlannerNode::on_frame(const std::string& frame_id) {
  planner_.clear_map();
  planner_.project();
  sender_.begin(frame_id);
}

/// At once: a robot may be on its way into a zone.
void PlannerNode::on_zones() {
  std::vector<Zone> all = zones_.items();
  all.insert(all.end(), label_zones_.items().begin(), label_zones_.items().end());
  planner_.set_zones(all);
  context_.counters.set("zones", static_cast<std::int64_t>(planner_.zones().size()));
  context_.counters.set("zones_not_cell_by_cell", static_cast<std::int64_t>(planner_.zones().coarse().size()));
  project();
  speak();
}

void PlannerNode::project() {
  for (const BrickIndex column : planner_.project()) sender_.touch(column);
}

/// What changed, and once a second what did not: the bus may lose a path, and silence means that none is kept.
void PlannerNode::speak() {
  for (const Path& path : planner_.replan(moment())) {
    context_.counters.add("paths." + path.status);
    publish(path);
  }
  for (const Path& path : planner_.repeat(moment())) publish(path);
  context_.counters.set("active_paths", static_cast<std::int64_t>(planner_.active_count()));
}

void PlannerNode::on_request(const PathRequest& request) {
  project();
  auto [path, ended] = planner_.request(request, context_.site.agent(request.robot).radius, moment());
  const bool ok = path.status == name(Reason::kOk);
  if (!ok && !receiver_.synced()) path.message += "; the map has not fully arrived yet";
  if (ok && !zones_.synced()) path.message += "; a change of the zones is under way";
  context_.counters.add("paths." + path.status);
  if (ended) publish(*ended);
  publish(path);
  answer(context_.bus, {path.id, context_.process, ok, path.status, path.message, path.map_revision,
                        static_cast<std::int64_t>(path.points.size())});
}

void PlannerNode::publish(const Path& path) { context_.bus.publish("out/path/" + path.robot, encode(path)); }

Planner::Moment PlannerNode::moment() const { return {receiver_.revision(), context_.bus.now()}; }

}  // namespace concord
