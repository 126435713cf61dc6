#include "planner/planner_node.hpp"

#include <chrono>
#include <cmath>
#include <set>
#include <string>

#include "planner/footprint/footprint_text.hpp"

namespace concord {
namespace {

constexpr std::int64_t kTick = 50'000;  ///< map changes are gathered for so long, microseconds

/// Merge says each second how its map is; after so long without a word nothing new is planned on it, microseconds.
constexpr std::int64_t kStale = 10'000'000;

Grid make_grid(const Site& site) {
  const Result<Band> band = make_band(site.planner.zmin, site.planner.zmax, site.resolution);
  if (!band) throw ConfigError("planner: " + band.error().message);
  return {site.resolution, *band, site.planner.free_share};
}

std::optional<Body> body_of(const std::string& id, const AgentConfig& agent) {
  if (agent.footprint.empty()) return std::nullopt;
  const auto footprint = read_footprint(agent.footprint);
  if (!footprint) throw ConfigError("agents." + id + ".footprint: " + footprint.error().message);
  return Body{*footprint, agent.turn_radius};
}

std::map<std::string, Body> bodies_of(const Site& site) {
  std::map<std::string, Body> bodies;
  for (const auto& [id, agent] : site.agents) {
    if (const auto body = body_of(id, agent)) bodies.emplace(id, *body);
  }
  return bodies;
}

}  // namespace

PlannerNode::PlannerNode(const NodeContext& context, std::launch how)
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
      label_zones_(context.bus, context.counters, "out/label_zones",
                   [this](const std::vector<Zone>&) {
                     if (zones_.synced()) on_zones();  // else they are still to come
                   }),
      watches_(context),
      blamed_(context),
      how_(how),
      bodies_(bodies_of(context.site)),
      unlisted_(body_of("unlisted", context.site.unlisted)) {
  Bus& bus = context_.bus;
  Counters& counters = context_.counters;
  const std::string& self = context_.process;
  listen<BrickPacket>(bus, counters, self, "out/map/bricks",
                      [this](const std::string&, const BrickPacket& packet) { receiver_.on_packet(packet); });
  listen<BrickDigest>(bus, counters, self, "out/map/digest", [this](const std::string&, const BrickDigest& digest) {
    map_heard_ = context_.bus.now();
    receiver_.on_digest(digest);
  });
  listen<MapPose>(bus, counters, self, "out/pose/.*", [this](const std::string& channel, const MapPose& pose) {
    const bool is_headset = context_.site.agent(pose.agent).kind == "headset";
    const double radius = is_headset ? 0.0 : robot(pose.agent).radius;
    const Eigen::Matrix3d& turned = pose.T_map_base.linear();
    const double yaw = std::atan2(turned(1, 0), turned(0, 0));
    if (!planner_.set_pose(pose.agent, pose.T_map_base.translation().head<2>(), radius, yaw)) {
      context_.counters.refused(channel, {Code::kTooLarge, "poses of more robots than are kept"});
    }
  });
  listen<AgentList>(bus, counters, self, "out/agents",
                    [this](const std::string&, const AgentList& list) { on_agents(list); });
  listen<HistoryPart>(bus, counters, self, "out/history", [this](const std::string&, const HistoryPart& part) {
    const auto blamed = blamed_.take(part);
    if (!blamed) return;
    if (const auto path = planner_.name_edit(blamed->robot, blamed->path_id, blamed->edit, blamed->author)) {
      publish(*path);
    }
  });
  listen<PathWatch>(bus, counters, self, "in/path_watch",
                    [this](const std::string& channel, const PathWatch& watch) { on_watch(channel, watch); });
  listen<PathRequest>(bus, counters, self, "in/path_request",
                      [this](const std::string&, const PathRequest& request) { on_request(request); });
  bus.every(kTick, [this] {
    project();
    go_on();
    speak();
  });
}

PlannerNode::~PlannerNode() {
  if (quest_) quest_->withdraw();
}

/// The search that is under way, if it has ended; and the next.
void PlannerNode::go_on() {
  if (search_.valid()) {
    if (search_.wait_for(std::chrono::seconds(0)) == std::future_status::timeout) return;
    search_.get();
  }
  quest_ = planner_.next_quest();
  if (quest_) search_ = std::async(how_, [quest = quest_] { quest->run(); });
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
  planner_.set_stale(map_heard_ != 0 && context_.bus.now() - map_heard_ > kStale);
  for (const Planner::Reply& answered : planner_.serve(moment())) reply(answered);
  for (const Path& path : planner_.replan(moment())) {
    context_.counters.add("paths." + path.status);
    publish(path);
  }
  for (const Path& path : planner_.repeat(moment())) publish(path);
  context_.counters.set("active_paths", static_cast<std::int64_t>(planner_.active_count()));
}

void PlannerNode::on_agents(const AgentList& list) {
  std::set<std::string> aligned;
  for (const AgentState& agent : list.agents) {
    if (agent.aligned) aligned.insert(agent.id);
  }
  planner_.keep_poses(aligned);
  for (const std::string& moved : watches_.set_agents(list)) {
    for (const Path& path : planner_.kept()) watches_.say(path, moved);
  }
}

Robot PlannerNode::robot(const std::string& id) const {
  const AgentConfig& agent = context_.site.agent(id);
  Robot robot{agent.radius, agent.speed, unlisted_, agent.band};
  if (context_.site.agents.contains(id)) {
    const auto it = bodies_.find(id);
    robot.body = it != bodies_.end() ? std::optional(it->second) : std::nullopt;
  }
  if (robot.body) robot.radius = robot.body->footprint.circumscribed();
  return robot;
}

void PlannerNode::on_request(const PathRequest& request) {
  if (request.op == PathRequest::Op::kCancel) return cancel(request);
  project();
  reply(planner_.request(request, robot(request.robot), moment()));
}

/// Asked again it finds nothing left, and that is as good.
void PlannerNode::cancel(const PathRequest& request) {
  const std::vector<Planner::Cancelled> ended = planner_.cancel(request.robot, moment());
  for (const auto& [path, was_answered] : ended) {
    context_.counters.add("paths." + path.status);
    publish(path);
    if (!was_answered) {
      answer(context_.bus, {path.id, context_.process, false, path.status, path.message, path.map_revision, 0});
    }
  }
  answer(context_.bus, {request.id, context_.process, true, "OK",
                        ended.empty() ? "nothing was kept or waited for " + request.robot : "cancelled",
                        receiver_.revision(), static_cast<std::int64_t>(ended.size())});
}

void PlannerNode::on_watch(const std::string& channel, const PathWatch& watch) {
  const Result<void> watched = watches_.watch(watch);
  if (!watched) context_.counters.refused(channel, watched.error());
  std::int64_t count = 0;
  for (const Path& path : planner_.kept()) {
    if (!watched || (!watch.robot.empty() && watch.robot != path.robot)) continue;
    watches_.say(path, watch.frame_agent);
    ++count;
  }
  answer(context_.bus,
         {watch.id, context_.process, watched.has_value(), watched ? "OK" : name(watched.error().code),
          watched ? "watched for 30 s: ask again before" : watched.error().message, receiver_.revision(), count});
}

/// Without a path the request waits for its turn.
void PlannerNode::reply(const Planner::Reply& reply) {
  if (!reply.path) return;
  Path path = *reply.path;
  const bool ok = path.status == name(Reason::kOk);
  if (!ok && !receiver_.synced()) path.message += "; the map has not fully arrived yet";
  if (ok && !zones_.synced()) path.message += "; a change of the zones is under way";
  context_.counters.add("paths." + path.status);
  if (reply.ended) publish(*reply.ended);
  publish(path);
  answer(context_.bus, {path.id, context_.process, ok, path.status, path.message, path.map_revision,
                        static_cast<std::int64_t>(path.points.size())});
}

void PlannerNode::publish(const Path& path) {
  context_.bus.publish("out/path/" + path.robot, encode(path));
  watches_.say(path);
  if (path.status == name(Reason::kBlockedByEdit) && path.edit_id.empty()) blame(path);
}

/// Once for each path: it is said again when its edit is known.
void PlannerNode::blame(const Path& path) {
  const auto cut = planner_.cut_of(path.robot, path.path_id);
  if (cut) blamed_.ask(path.robot, path.path_id, cut->p, cut->band);
}

/// What was planned on a map with holes must not pass for one that knows what lies in them.
Planner::Moment PlannerNode::moment() const { return {receiver_.whole_revision(), context_.bus.now()}; }

}  // namespace concord
