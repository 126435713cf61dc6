#include "merge/merge_node.hpp"

#include <algorithm>
#include <stdexcept>

#include <spdlog/spdlog.h>

namespace concord {
namespace {

constexpr std::int64_t kRefoldPeriod = 20'000;
constexpr std::int64_t kAgentsPeriod = 1'000'000;
/// After a restart the map is held back until it is whole again, so that nobody sees it shrink; but not for ever when
/// nothing more arrives.
constexpr std::int64_t kLongestWait = 10'000'000;
constexpr std::int64_t kPoseSilence = 3'000'000;
const std::string kStreamPrefix = "out/agent/";

BrickSender::Config stream_config(const NodeContext& context, const std::string& stream) {
  return {stream, context.site.resolution, context.site.stream.bytes_per_second, context.boot_id};
}

/// "out/agent/ID/bricks" and "in/ID/pose" name their agent between prefix and last slash.
std::string agent_in(const std::string& channel, std::size_t prefix) {
  return channel.substr(prefix, channel.rfind('/') - prefix);
}

}  // namespace

MergeNode::MergeNode(const NodeContext& context)
    : context_(context),
      store_(context.site.state / "merge.db", context.site.resolution),
      maps_(context.site.state / "maps"),
      layers_(context.site.resolution, context.site.merge.policy),
      map_stream_(context.bus, context.counters, stream_config(context, "out/map"), layers_.map()),
      conflict_stream_(context.bus, context.counters, stream_config(context, "out/conflicts"), layers_.conflicts()),
      answers_(context.bus),
      last_arrival_(context.bus.now()) {
  restore();
  listen_to_agents();
  listen_to_people();
  context_.bus.every(kRefoldPeriod, [this] { refold_and_send(); });
  context_.bus.every(kAgentsPeriod, [this] { publish_agents(); });
}

void MergeNode::restore() {
  const auto transforms = store_.transforms();
  if (!transforms) throw std::runtime_error(transforms.error().message);
  for (const MergeStore::Placed& placed : *transforms) {
    agents_[placed.agent].placed[{placed.frame_id, placed.incarnation}] = placed.T_map_agent;
    if (placed.has_layer) awaited_.insert(placed.agent);
  }
  const auto edits = store_.for_each_edit([this](const EditRequest& edit) { layers_.apply(edit); });
  if (!edits) throw std::runtime_error(edits.error().message);
  spdlog::info("restored {} transforms and {} edits", transforms->size(), layers_.edits().revision());
}

void MergeNode::listen_to_agents() {
  listen<BrickPacket>(context_.bus, context_.counters, context_.process, kStreamPrefix + "[^/]+/bricks",
                      [this](const std::string& channel, const BrickPacket& packet) {
                        if (BrickReceiver* stream = stream_of_channel(channel)) stream->on_packet(packet);
                      });
  listen<BrickDigest>(context_.bus, context_.counters, context_.process, kStreamPrefix + "[^/]+/digest",
                      [this](const std::string& channel, const BrickDigest& digest) {
                        // Who was removed before this start need not become known to be gone.
                        if (digest.frame_id.empty() && !agents_.contains(agent_in(channel, kStreamPrefix.size())))
                          return;
                        if (BrickReceiver* stream = stream_of_channel(channel)) stream->on_digest(digest);
                      });
  listen<AgentPose>(context_.bus, context_.counters, context_.process, "in/[^/]+/pose",
                    [this](const std::string& channel, AgentPose pose) { on_pose(channel, std::move(pose)); });
}

void MergeNode::listen_to_people() {
  listen<TransformRequest>(context_.bus, context_.counters, context_.process, "in/transform",
                           [this](const std::string&, const TransformRequest& request) { on_transform(request); });
  listen<MapRequest>(context_.bus, context_.counters, context_.process, "in/map_request",
                     [this](const std::string&, const MapRequest& request) { on_map_request(request); });
  context_.bus.subscribe("in/edit", [this](const std::string& channel, std::span<const std::uint8_t> bytes) {
    const auto request = decode_edit(bytes, context_.site.resolution);
    if (request) return on_edit(*request);
    refuse_edit(channel, request.error());
  });
}

/// Null if there is no room for one more, or none can have this name.
MergeNode::Agent* MergeNode::agent_called(const std::string& id, const std::string& channel) {
  const auto it = agents_.find(id);
  if (it != agents_.end()) return &it->second;
  const auto there = std::ranges::count_if(agents_, [](const auto& entry) { return !entry.second.frame_id.empty(); });
  if (!is_name(id) || there >= context_.site.ingest.max_agents) {
    context_.counters.refused(channel, {Code::kBadName, "no room for an agent of this name"});
    return nullptr;
  }
  return &agents_[id];
}

BrickReceiver* MergeNode::stream_of_channel(const std::string& channel) {
  const std::string id = agent_in(channel, kStreamPrefix.size());
  Agent* agent = agent_called(id, channel);
  if (agent == nullptr) return nullptr;
  if (!agent->stream) open_stream(id, *agent);
  return agent->stream.get();
}

void MergeNode::open_stream(const std::string& id, Agent& agent) {
  BrickReceiver::Events events;
  events.on_frame = [this, id](const std::string& frame_id) {
    layers_.begin_layer(id, frame_id, context_.site.agent(id).weight);
    agents_[id].incarnation = agents_[id].stream->incarnation();
    enter_frame(id, agents_[id], frame_id);
  };
  events.on_brick = [this, id](BrickIndex index, Brick brick) {
    last_arrival_ = context_.bus.now();
    layers_.set_brick(id, index, std::move(brick));
  };
  events.on_end = [this, id] { leave(id); };
  agent.stream = std::make_unique<BrickReceiver>(context_.bus, context_.counters,
                                                 BrickReceiver::Config{kStreamPrefix + id, context_.site.resolution},
                                                 std::move(events));
}

/// A transform holds for the frame it was found in; a frame that nobody has aligned waits outside the map.
void MergeNode::enter_frame(const std::string& id, Agent& agent, const std::string& frame_id) {
  agent.frame_id = frame_id;
  const Transform* T = agent.T_map_agent();
  if (T != nullptr && layers_.find(id) != nullptr) layers_.place(id, *T);
}

/// The agent was removed. Where people put it stays on disk; it holds for that incarnation, which does not come again.
void MergeNode::leave(const std::string& id) {
  layers_.remove_layer(id);
  awaited_.erase(id);
  Agent& agent = agents_[id];
  agent.frame_id.clear();
  agent.pose.reset();
}

void MergeNode::on_pose(const std::string& channel, AgentPose pose) {
  pose.agent = agent_in(channel, 3);
  Agent* agent = agent_called(pose.agent, channel);
  if (agent == nullptr) return;
  if (agent->frame_id.empty() || !agent->stream) enter_frame(pose.agent, *agent, pose.frame_id);
  if (pose.frame_id != agent->frame_id) {
    return context_.counters.refused(channel, {Code::kBadFrame, "pose is in a frame other than the submap's"});
  }
  const std::int64_t time = context_.bus.now();
  const bool silent = time - agent->pose_heard > kPoseSilence;  // then a robot's clock may have gone back
  if (agent->pose && agent->pose->frame_id == pose.frame_id && pose.utime <= agent->pose->utime && !silent) {
    return context_.counters.refused(channel, {Code::kStale, "pose is not newer than the last"});
  }
  agent->pose_heard = time;
  agent->pose = std::move(pose);
  publish_pose(agent->pose->agent, *agent);
}

void MergeNode::on_transform(const TransformRequest& request) {
  const std::uint64_t content = content_of(request);
  if (answers_.repeat(request.id, context_.process, content)) return;
  const auto it = agents_.find(request.agent);
  if (it == agents_.end() || it->second.frame_id.empty()) {
    return deny(request.id, {Code::kNoAgent, "no agent " + request.agent + " has been heard; see: concord agents"});
  }
  Agent& agent = it->second;
  if (!request.frame_id.empty() && request.frame_id != agent.frame_id) {
    return deny(request.id, {Code::kBadFrame, request.agent + " is in frame " + agent.frame_id + " now"});
  }
  if (!layers_.fits(request.agent, request.T_map_agent)) {
    return deny(request.id, {Code::kOutOfBounds, request.agent + " would lie beyond the map's bounds there"});
  }
  const bool has_layer = layers_.find(request.agent) != nullptr;
  const MergeStore::Placed placed{request.agent, agent.frame_id, agent.incarnation, has_layer, request.T_map_agent};
  if (const auto done = store_.put_transform(placed, request.author, context_.bus.now()); !done) {
    return deny(request.id, done.error());
  }
  agent.placed[{agent.frame_id, agent.incarnation}] = request.T_map_agent;
  enter_frame(request.agent, agent, agent.frame_id);
  refold_and_send();
  answers_.give(granted(request.id, map_stream_.revision(), 1, request.agent + " is placed"), content);
  publish_pose(request.agent, agent);
}

void MergeNode::on_edit(const EditRequest& request) {
  const auto count = static_cast<std::int64_t>(request.voxels.size());
  if (const EditLayer::Applied* before = layers_.edits().find(request.id)) {
    if (before->content != EditLayer::content(request)) {
      return deny(request.id, {Code::kExists, "another edit had this id; ids must be unique"});
    }
    return answer(context_.bus, granted(request.id, before->revision, count, "this edit was applied before"));
  }
  if (const auto done = store_.put_edit(request); !done) return deny(request.id, done.error());
  layers_.apply(request);
  refold_and_send();
  answer(context_.bus, granted(request.id, layers_.edits().revision(), count, "pinned"));
}

void MergeNode::refuse_edit(const std::string& channel, const BadMessage& bad) {
  context_.counters.refused(channel, bad.error);
  if (!bad.id.empty()) {
    answer(context_.bus, {bad.id, context_.process, false, name(bad.error.code), bad.error.message, 0, 0});
  }
}

void MergeNode::on_map_request(const MapRequest& request) {
  if (request.op == MapRequest::Op::kSave) save(request);
  if (request.op == MapRequest::Op::kList) list(request);
}

void MergeNode::save(const MapRequest& request) {
  const std::uint64_t content = content_of(request);
  if (answers_.repeat(request.id, context_.process, content)) return;
  refold_and_send();
  if (!streaming_) {
    return deny(request.id, {Code::kBusy, "the map is not whole again after a restart; ask again in some seconds"});
  }
  const auto bytes =
      maps_.save(layers_.map(), context_.site.resolution, request.map, request.format, request.overwrite);
  if (!bytes) return deny(request.id, bytes.error());
  const std::string file = request.map + "." + request.format;
  answers_.give(granted(request.id, map_stream_.revision(), *bytes, "saved " + file), content);
}

void MergeNode::list(const MapRequest& request) {
  const auto files = maps_.list();
  if (!files) return deny(request.id, files.error());
  context_.bus.publish("out/map_list", encode(MapList{request.id, *files}, context_.bus.now()));
  answer(context_.bus, granted(request.id, 0, static_cast<std::int64_t>(files->size()), "listed"));
}

void MergeNode::refold_and_send() {
  const LayeredMap::Changes changes = layers_.refold();
  if (!streaming_) return start_map_streams_when_ready();
  for (const BrickIndex index : changes.map) map_stream_.touch(index);
  for (const BrickIndex index : changes.conflicts) conflict_stream_.touch(index);
  if (!changes.map.empty()) map_stream_.send_now();
  if (!changes.conflicts.empty()) conflict_stream_.send_now();
}

void MergeNode::start_map_streams_when_ready() {
  if (!has_all_that_was_aligned() && context_.bus.now() - last_arrival_ < kLongestWait) return;
  map_stream_.begin("map");
  conflict_stream_.begin("map");
  streaming_ = true;
}

bool MergeNode::has_all_that_was_aligned() const {
  for (const std::string& id : awaited_) {
    const auto it = agents_.find(id);
    if (it == agents_.end() || !it->second.stream || !it->second.stream->synced()) return false;
  }
  return true;
}

void MergeNode::publish_agents() {
  AgentList list{context_.bus.now(), {}};
  for (const auto& [id, agent] : agents_) {
    if (agent.frame_id.empty()) continue;
    AgentState state;
    state.id = id;
    state.kind = context_.site.agent(id).kind;
    state.frame_id = agent.frame_id;
    state.weight = context_.site.agent(id).weight;
    const Transform* T = agent.T_map_agent();
    state.aligned = T != nullptr;
    if (T != nullptr) state.T_map_agent = *T;
    if (const LayeredMap::AgentLayer* layer = layers_.find(id)) {
      state.known = layer->known;
      state.occupied = layer->occupied;
    }
    if (agent.stream) {
      state.revision = agent.stream->revision();
      state.synced = agent.stream->synced();
    }
    list.agents.push_back(std::move(state));
  }
  context_.bus.publish("out/agents", encode(list));
  context_.counters.set("agents", static_cast<std::int64_t>(list.agents.size()));
  context_.counters.set("map_bricks", static_cast<std::int64_t>(layers_.map().brick_count()));
  context_.counters.set("map_revision", map_stream_.revision());
  context_.counters.set("edit_revision", layers_.edits().revision());
  context_.counters.set("bytes_sent", map_stream_.bytes_sent() + conflict_stream_.bytes_sent());
}

void MergeNode::publish_pose(const std::string& id, const Agent& agent) {
  const Transform* T = agent.T_map_agent();
  if (!agent.pose || T == nullptr || agent.pose->frame_id != agent.frame_id) return;
  const MapPose pose{agent.pose->utime, id, *T * agent.pose->T_agent_base};
  context_.bus.publish("out/pose/" + id, encode(pose));
}

Answer MergeNode::granted(const std::string& id, std::int64_t revision, std::int64_t count,
                          const std::string& message) const {
  return {id, context_.process, true, "OK", message, revision, count};
}

void MergeNode::deny(const std::string& id, const Error& error) {
  context_.counters.refused("request", error);
  answer(context_.bus, {id, context_.process, false, name(error.code), error.message, 0, 0});
}

}  // namespace concord
