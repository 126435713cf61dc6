#include "merge/agents_node.hpp"

#include <algorithm>
#include <utility>

namespace concord {
namespace {

constexpr std::int64_t kAgentsPeriod = 1'000'000;
/// After a restart the map is held back until it is whole again, so that nobody sees it shrink; but not for ever when
/// nothing more arrives.
constexpr std::int64_t kLongestWait = 10'000'000;
constexpr std::int64_t kPoseSilence = 3'000'000;
/// Ingest says each second of every agent that it is there; some of that may be lost.
constexpr std::int64_t kAllHeard = 3'000'000;
const std::string kStreamPrefix = "out/agent/";

/// "out/agent/ID/bricks" and "in/ID/pose" name their agent between prefix and last slash.
std::string agent_named(const std::string& channel, std::size_t prefix) {
  return channel.substr(prefix, channel.rfind('/') - prefix);
}

}  // namespace

AgentsNode::AgentsNode(const NodeContext& context, const People& people, MapStreams& map)
    : context_(context), people_(people), map_(map), last_arrival_(context.bus.now()) {
  for (const auto& [id, placements] : people_.placements()) {
    const auto awaits = [](const People::Placed& placed) { return placed.stands && placed.placement.has_layer; };
    if (std::ranges::any_of(placements, [&](const auto& entry) { return std::ranges::any_of(entry.second, awaits); }))
      awaited_.insert(id);
  }
  listen();
  context_.bus.every(kAgentsPeriod, [this] { publish_agents(); });
}

void AgentsNode::listen() {
  concord::listen<BrickPacket>(context_.bus, context_.counters, context_.process, kStreamPrefix + "[^/]+/bricks",
                               [this](const std::string& channel, const BrickPacket& packet) {
                                 if (BrickReceiver* stream = stream_of_channel(channel)) stream->on_packet(packet);
                               });
  concord::listen<BrickDigest>(context_.bus, context_.counters, context_.process, kStreamPrefix + "[^/]+/digest",
                               [this](const std::string& channel, const BrickDigest& digest) {
                                 // Who was removed before this start need not become known to be gone.
                                 const std::string id = agent_named(channel, kStreamPrefix.size());
                                 if (digest.frame_id.empty() && !agents_.contains(id) && !awaited_.contains(id)) return;
                                 if (BrickReceiver* stream = stream_of_channel(channel)) stream->on_digest(digest);
                               });
  concord::listen<ProcessStatus>(context_.bus, context_.counters, context_.process, "out/status/ingest",
                                 [this](const std::string&, const ProcessStatus& status) { on_ingest(status); });
  concord::listen<AgentPose>(context_.bus, context_.counters, context_.process, "in/[^/]+/pose",
                             [this](const std::string& channel, AgentPose pose) { on_pose(channel, std::move(pose)); });
}

/// One that was silent for long, or has begun anew, has its agents still to name.
void AgentsNode::on_ingest(const ProcessStatus& status) {
  const std::int64_t time = context_.bus.now();
  const bool goes_on = ingest_ && ingest_->boot_id == status.boot_id && time - ingest_->last < kAllHeard;
  ingest_ = {status.boot_id, goes_on ? ingest_->first : time, time};
}

/// Null if there is no room for one more, or none can have this name.
AgentsNode::Agent* AgentsNode::agent_called(const std::string& id, const std::string& channel) {
  const auto it = agents_.find(id);
  if (it != agents_.end()) return &it->second;
  if (!is_name(id) || (!awaited_.contains(id) && !make_room())) {
    context_.counters.refused(channel, {Code::kBadName, "no room for an agent of this name"});
    return nullptr;
  }
  return &agents_[id];
}

/// For one more: who is not there, having left or said no frame yet, gives way. Returns whether there is.
bool AgentsNode::make_room() {
  const auto most = static_cast<std::size_t>(context_.site.ingest.max_agents);
  if (agents_.size() < most) return true;
  const auto absent = std::ranges::find_if(agents_, [](const auto& entry) { return entry.second.frame_id.empty(); });
  if (absent == agents_.end()) return false;
  agents_.erase(absent);
  return true;
}

BrickReceiver* AgentsNode::stream_of_channel(const std::string& channel) {
  const std::string id = agent_named(channel, kStreamPrefix.size());
  Agent* agent = agent_called(id, channel);
  if (agent == nullptr) return nullptr;
  if (!agent->stream) open_stream(id, *agent);
  return agent->stream.get();
}

void AgentsNode::open_stream(const std::string& id, Agent& agent) {
  BrickReceiver::Events events;
  events.on_frame = [this, id](const std::string& frame_id) {
    Agent& entering = agents_[id];
    map_.layers().begin_layer(id, frame_id, weight_of(id));
    entering.incarnation = entering.stream->incarnation();
    enter_frame(id, entering, frame_id);
  };
  events.on_brick = [this, id](BrickIndex index, Brick brick) {
    last_arrival_ = context_.bus.now();
    map_.layers().set_brick(id, index, std::move(brick));
  };
  events.on_end = [this, id] { leave(id); };
  agent.stream = std::make_unique<BrickReceiver>(context_.bus, context_.counters,
                                                 BrickReceiver::Config{kStreamPrefix + id, context_.site.resolution},
                                                 std::move(events));
}

/// A transform holds for the frame it was found in; a frame that nobody has aligned waits outside the map.
void AgentsNode::enter_frame(const std::string& id, Agent& agent, const std::string& frame_id) {
  agent.frame_id = frame_id;
  agent.poses.clear();
  follow(id);
}

void AgentsNode::follow(const std::string& id) {
  const auto it = agents_.find(id);
  if (it == agents_.end()) return;
  const Transform* T = T_map_agent(id, it->second);
  if (map_.layers().find(id) != nullptr) {
    map_.layers().set_weight(id, weight_of(id));
    T != nullptr ? map_.layers().place(id, *T) : map_.layers().unplace(id);
  }
  publish_pose(id, it->second);
}

/// The agent was removed. Where people put it stays on disk; it holds for that incarnation, which does not come again.
void AgentsNode::leave(const std::string& id) {
  map_.layers().remove_layer(id);
  awaited_.erase(id);
  Agent& agent = agents_[id];
  agent.incarnation = 0;
  agent.frame_id.clear();
  agent.pose.reset();
  agent.poses.clear();
}

void AgentsNode::on_pose(const std::string& channel, AgentPose pose) {
  pose.agent = agent_named(channel, 3);
  Agent* agent = agent_called(pose.agent, channel);
  if (agent == nullptr) return;
  const bool is_new_frame = pose.frame_id != agent->frame_id;
  if (agent->frame_id.empty() || (!agent->has_layer() && is_new_frame)) enter_frame(pose.agent, *agent, pose.frame_id);
  if (pose.frame_id != agent->frame_id) {
    return context_.counters.refused(channel, {Code::kBadFrame, "pose is in a frame other than the submap's"});
  }
  const std::int64_t time = context_.bus.now();
  const bool silent = time - agent->pose_heard > kPoseSilence;  // then a robot's clock may have gone back
  if (agent->pose && agent->pose->frame_id == pose.frame_id && pose.utime <= agent->pose->utime && !silent) {
    return context_.counters.refused(channel, {Code::kStale, "pose is not newer than the last"});
  }
  if (const auto added = agent->poses.add(pose.utime, pose.T_agent_base); !added) {
    return context_.counters.refused(channel, added.error());
  }
  agent->pose_heard = time;
  agent->pose = std::move(pose);
  publish_pose(agent->pose->agent, *agent);
}

Result<const AgentsNode::Agent*> AgentsNode::agent_in(const std::string& id, const std::string& frame_id) const {
  const auto it = agents_.find(id);
  // An agent that is awaited may be heard by its poses before its layer: what was asked of it then would hold for none.
  const bool has_layer = it != agents_.end() && it->second.has_layer();
  if (!has_layer && awaited_.contains(id) && !map_.begun()) {
    return refuse(Code::kBusy, "the layer of " + id + " has not been heard since merge began; ask again in a second");
  }
  if (it == agents_.end() || it->second.frame_id.empty()) {
    return refuse(Code::kNoAgent, "no agent " + id + " has been heard; see: concord agents");
  }
  if (!frame_id.empty() && frame_id != it->second.frame_id) {
    return refuse(Code::kBadFrame, id + " is in frame " + it->second.frame_id + " now");
  }
  return &it->second;
}

Result<Transform> AgentsNode::T_map_frame(const WorkFrame& frame) const {
  if (frame.agent.empty()) return Transform::Identity();
  const auto agent = agent_in(frame.agent, frame.frame_id);
  if (!agent) return tl::unexpected(agent.error());
  const Transform* T = T_map_agent(frame.agent, **agent);
  if (T == nullptr) return refuse(Code::kNotAligned, "nobody knows where " + frame.agent + " is in the map; align it");
  return *T;
}

Result<Correction::Placement> AgentsNode::check(const TransformRequest& request) const {
  const auto agent = agent_in(request.agent, request.frame_id);
  if (!agent) return tl::unexpected(agent.error());
  return placement(request.agent, **agent, request.T_map_agent);
}

Result<Correction::Placement> AgentsNode::check(const LocaliseRequest& request) const {
  const auto agent = agent_in(request.agent, "");
  if (!agent) return tl::unexpected(agent.error());
  const auto T_map_seen = T_map_frame(request.frame);
  if (!T_map_seen) return tl::unexpected(T_map_seen.error());
  const auto T_agent_base = (*agent)->poses.at(request.utime);
  if (!T_agent_base) return tl::unexpected(T_agent_base.error());
  const Transform T = *T_map_seen * request.T_frame_base * T_agent_base->inverse();
  // As it comes from outside: a product drifts off a rotation, and people may be far away.
  const auto T_map_agent = make_transform(T.translation(), Eigen::Quaterniond(T.linear()).coeffs());
  if (!T_map_agent) return tl::unexpected(T_map_agent.error());
  return placement(request.agent, **agent, *T_map_agent);
}

Result<Correction::Weight> AgentsNode::check(const WeightRequest& request) const {
  const auto agent = agent_in(request.agent, "");
  if (!agent) return tl::unexpected(agent.error());
  return Correction::Weight{request.agent, request.weight};
}

Result<Correction::Placement> AgentsNode::placement(const std::string& id, const Agent& agent,
                                                    const Transform& T_map_agent) const {
  const LayeredMap& layers = map_.layers();
  if (!layers.fits(id, T_map_agent)) {
    return refuse(Code::kOutOfBounds, id + " would lie beyond the map's bounds there");
  }
  return Correction::Placement{id, agent.frame_id, agent.incarnation, layers.find(id) != nullptr, T_map_agent};
}

const Transform* AgentsNode::T_map_agent(const std::string& id, const Agent& agent) const {
  return agent.frame_id.empty() ? nullptr : people_.T_map_agent(id, agent.frame_id, agent.incarnation);
}

int AgentsNode::weight_of(const std::string& id) const {
  return people_.weight(id).value_or(context_.site.agent(id).weight);
}

bool AgentsNode::all_heard() const {
  const std::int64_t time = context_.bus.now();
  return ingest_ && time - ingest_->first >= kAllHeard && time - ingest_->last < kAllHeard;
}

bool AgentsNode::has_all_that_was_aligned() const {
  const bool all = std::ranges::all_of(awaited_, [&](const std::string& id) {
    const auto it = agents_.find(id);
    const bool is_there = it != agents_.end() && it->second.stream;
    return is_there ? it->second.stream->synced() : all_heard();
  });
  return all || context_.bus.now() - last_arrival_ >= kLongestWait;
}

Result<void> AgentsNode::all_whole() const {
  if (!all_heard()) {
    return refuse(Code::kBusy,
                  "ingest has not been heard for 3 s since merge began, so some layers may be missing; "
                  "does it run? ask again in some seconds");
  }
  for (const auto& [id, agent] : agents_) {
    if (!agent.has_layer()) continue;
    const bool is_settled = !people_.carried_over(id, agent.frame_id, agent.incarnation, context_.bus.now());
    if (!agent.stream->synced() || !is_settled) {
      return refuse(Code::kBusy, "the layer of " + id + " is not whole here; ask again in a second");
    }
  }
  return {};
}

std::vector<Correction> AgentsNode::carried_over() const {
  std::vector<Correction> out;
  for (const auto& [id, agent] : agents_) {
    if (!agent.has_layer()) continue;
    auto carried = people_.carried_over(id, agent.frame_id, agent.incarnation, context_.bus.now());
    if (!carried) continue;
    carried->revision += static_cast<std::int64_t>(out.size());
    out.push_back(std::move(*carried));
  }
  return out;
}

std::optional<AgentState> AgentsNode::state_of(const std::string& id) const {
  const auto it = agents_.find(id);
  if (it == agents_.end() || it->second.frame_id.empty()) return std::nullopt;
  const Agent& agent = it->second;
  AgentState state;
  state.id = id;
  state.kind = context_.site.agent(id).kind;
  state.frame_id = agent.frame_id;
  state.weight = weight_of(id);
  const Transform* T = T_map_agent(id, agent);
  state.aligned = T != nullptr;
  if (T != nullptr) state.T_map_agent = *T;
  if (const LayeredMap::AgentLayer* layer = map_.layers().find(id)) {
    state.known = layer->known;
    state.occupied = layer->occupied;
  }
  if (agent.stream) {
    state.revision = agent.stream->revision();
    state.synced = agent.stream->synced();
  }
  return state;
}

void AgentsNode::publish_agents() {
  AgentList list{context_.bus.now(), context_.site.resolution, {}};
  for (const auto& [id, agent] : agents_) {
    if (auto state = state_of(id)) list.agents.push_back(std::move(*state));
  }
  context_.bus.publish("out/agents", encode(list));
  context_.counters.set("agents", static_cast<std::int64_t>(list.agents.size()));
  context_.counters.set("agents_without_frame", static_cast<std::int64_t>(agents_.size() - list.agents.size()));
}

void AgentsNode::publish_pose(const std::string& id, const Agent& agent) {
  const Transform* T = T_map_agent(id, agent);
  if (!agent.pose || T == nullptr || agent.pose->frame_id != agent.frame_id) return;
  const MapPose pose{agent.pose->utime, id, *T * agent.pose->T_agent_base};
  context_.bus.publish("out/pose/" + id, encode(pose));
}

}  // namespace concord
