#include "bridge/world.hpp"

#include <algorithm>

#include "bridge/convert.hpp"

namespace concord::hmd {
namespace {

constexpr std::int64_t kPublish = 20'000;  // microseconds
constexpr std::int64_t kPeople = 100'000;
constexpr std::size_t kMaxRobots = 1000;

VoxelMask occupied(const Brick& brick) { return brick.occupied(); }

VoxelMask free_cells(const Brick& brick) {
  VoxelMask mask = brick.known();
  const VoxelMask taken = brick.occupied();
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] &= ~taken[i];
  return mask;
}

/// Sessions without a connection look at nothing: when they come back their views begin anew.
bool is_looked_at(Hub& hub, std::uint32_t stream) {
  return std::any_of(hub.sessions().begin(), hub.sessions().end(), [stream](const auto& entry) {
    return entry.second.connection && entry.second.views.contains(stream);
  });
}

}  // namespace

World::World(const NodeContext& context, Hub& hub)
    : context_(context),
      hub_(hub),
      map_(context, hub,
           {.stream = "out/map",
            .number = kMapStream,
            .keep = true,
            .shown = occupied,
            .second = {},
            .shown_second = {}}),
      conflicts_(
          context, hub,
          {.stream = "out/conflicts", .number = kConflictStream, .shown = occupied, .second = {}, .shown_second = {}}),
      grid_(context, hub,
            {.stream = "out/grid",
             .number = kGridOccupiedStream,
             .keep = true,
             .shown = occupied,
             .second = kGridFreeStream,
             .shown_second = free_cells,
             .levels = 1}),
      labels_(context, hub),
      things_(context, hub),
      zones_(context.bus, context.counters, "out/zones",
             [this](const std::vector<concord::Zone>& zones) {
               ZonesEvent event;
               for (const concord::Zone& zone : zones) {
                 event.zones.push_back(to_hmd(zone));
                 note_correction(zone.revision);
               }
               hub_.tell_all("zones", event_text(event));
             }),
      leases_(context.bus, context.counters, "out/leases", [this](const std::vector<concord::Lease>& leases) {
        LeasesEvent event;
        for (const concord::Lease& lease : leases) event.leases.push_back(to_hmd(lease));
        hub_.tell_all("leases", event_text(event));
      }) {
  hear();
  Bus& bus = context_.bus;
  bus.every(kPublish, [this] { publish_layers(); });
  bus.every(kPeople, [this] {
    tell_poses();
    tell_people();
  });
  bus.every(1'000'000, [this] { tell_processes(); });
}

void World::hear() {
  Bus& bus = context_.bus;
  Counters& counters = context_.counters;
  const std::string& self = context_.process;
  listen<AgentList>(bus, counters, self, "out/agents",
                    [this](const std::string&, const AgentList& list) { take_agents(list); });
  listen<MapEdits>(bus, counters, self, "out/map_edits", [this](const std::string&, const MapEdits& edits) {
    map_edits_ = edits;
    note_correction(edits.edit_revision);
  });
  listen<MapPose>(bus, counters, self, "out/pose/.*", [this](const std::string&, const MapPose& pose) {
    if (poses_.size() >= kMaxRobots && !poses_.contains(pose.agent)) return;
    poses_.insert_or_assign(pose.agent, SeenPose{pose.T_map_base, pose.utime, context_.bus.now()});
  });
  listen<concord::Path>(bus, counters, self, "out/path/.*",
                        [this](const std::string&, const concord::Path& path) { take_path(path); });
  listen<ProcessStatus>(bus, counters, self, "out/status/.*", [this](const std::string&, const ProcessStatus& status) {
    const bool news =
        processes_.size() < kMaxRobots && processes_.insert_or_assign(status.process, context_.bus.now()).second;
    if (news) tell_processes();
  });
}

void World::take_agents(const AgentList& list) {
  agents_.clear();
  for (const AgentState& agent : list.agents) agents_.emplace(agent.id, agent);
  std::erase_if(poses_, [this](const auto& entry) {
    const AgentState* known = agent(entry.first);
    return known == nullptr || !known->aligned;
  });
  AgentsEvent event;
  for (const auto& [id, state] : agents_) {
    if (event.agents.size() < kMaxRobots) event.agents.push_back(to_hmd(state));
  }
  std::string text = event_text(event);
  if (text != told_agents_) hub_.tell_all("agents", told_agents_ = std::move(text));
  if (on_agents) on_agents();
}

void World::take_path(const concord::Path& path) {
  if (path.active) {
    if (paths_.size() < kMaxRobots || paths_.contains(path.robot))
      paths_.insert_or_assign(path.robot, SeenPath{path, context_.bus.now()});
  } else if (const auto it = paths_.find(path.robot); it != paths_.end() && it->second.path.id == path.id) {
    paths_.erase(it);
  }
  if (on_path) on_path(path);
}

const AgentState* World::agent(const std::string& id) const {
  const auto it = agents_.find(id);
  return it != agents_.end() ? &it->second : nullptr;
}

const World::SeenPose* World::pose(const std::string& agent) const {
  const auto it = poses_.find(agent);
  return it != poses_.end() ? &it->second : nullptr;
}

const concord::Path* World::active_path(const std::string& robot) const {
  const auto it = paths_.find(robot);
  return it != paths_.end() && context_.bus.now() - it->second.heard < kSilent ? &it->second.path : nullptr;
}

const concord::Path* World::last_path(const std::string& robot) const {
  const auto it = paths_.find(robot);
  return it != paths_.end() ? &it->second.path : nullptr;
}

std::vector<const concord::Path*> World::active_paths() const {
  std::vector<const concord::Path*> paths;
  for (const auto& [robot, seen] : paths_) {
    if (context_.bus.now() - seen.heard < kSilent) paths.push_back(&seen.path);
  }
  return paths;
}

bool World::alive(const std::string& process) const {
  const auto it = processes_.find(process);
  return it != processes_.end() && context_.bus.now() - it->second < kSilent;
}

LayerCopy* World::agent_layer(const std::string& id) {
  if (const auto it = agent_layers_.find(id); it != agent_layers_.end()) return it->second.get();
  if (agent(id) == nullptr) return nullptr;
  if (agent_layers_.size() >= kMaxAgentLayers) {
    const auto unseen = std::find_if(agent_layers_.begin(), agent_layers_.end(),
                                     [this](const auto& entry) { return !is_looked_at(hub_, entry.second->number()); });
    if (unseen == agent_layers_.end()) return nullptr;
    hub_.layers().close(unseen->second->number());
    agent_layers_.erase(unseen);
  }
  auto layer = std::make_unique<LayerCopy>(
      context_, hub_,
      LayerCopy::Config{
          .stream = "out/agent/" + id, .number = next_stream_++, .shown = occupied, .second = {}, .shown_second = {}});
  return agent_layers_.emplace(id, std::move(layer)).first->second.get();
}

void World::publish_layers() {
  map_.publish();
  conflicts_.publish();
  grid_.publish();
  labels_.publish();
  for (auto& [id, layer] : agent_layers_) layer->publish();
}

void World::tell_processes() {
  ProcessesEvent event;
  for (const auto& [process, heard] : processes_) {
    if (alive(process) && event.alive.size() < 64) event.alive.push_back(process);
  }
  std::string text = event_text(event);
  if (text != told_processes_) hub_.tell_all("processes", told_processes_ = std::move(text));
}

void World::tell_poses() {
  PosesEvent event;
  for (const auto& [id, pose] : poses_) event.poses.push_back({id, to_hmd(pose.T_map_base), pose.utime, stale(pose)});
  std::string text = event_text(event);
  if (text != told_poses_) hub_.tell_all("poses", told_poses_ = std::move(text));
}

/// Each client is told of all others. Who is an agent says where it is in its own frame.
void World::tell_people() {
  std::vector<Person> people;
  for (const auto& [number, session] : hub_.sessions()) {
    if (!session.connection || people.size() >= 256) continue;
    Person person{number, session.identity.name, session.device, {}, {}};
    std::optional<Transform> T_map_frame = Transform::Identity();
    if (!session.agent.empty()) {
      const AgentState* state = agent(session.agent);
      const bool placed =
          state != nullptr && state->aligned && state->frame_id == session.frame_id && !session.tracking_lost;
      T_map_frame = placed ? std::optional(state->T_map_agent) : std::nullopt;
    }
    if (T_map_frame && session.T_own_head) person.T_map_head = to_hmd(*T_map_frame * *session.T_own_head);
    if (T_map_frame && session.pointer) person.p_map_pointer = array_of(*T_map_frame * *session.pointer);
    people.push_back(std::move(person));
  }
  std::erase_if(told_people_, [this](const auto& entry) {
    const Session* session = hub_.find(entry.first);
    return session == nullptr || !session->connection;
  });
  for (auto& [number, session] : hub_.sessions()) {
    if (!session.connection) continue;
    PeopleEvent event;
    std::copy_if(people.begin(), people.end(), std::back_inserter(event.people),
                 [n = number](const Person& p) { return p.person != n; });
    std::string text = event_text(event);
    std::string& told = told_people_[number];
    if (text != told) hub_.tell(session, "people", told = std::move(text));
  }
}

}  // namespace concord::hmd
