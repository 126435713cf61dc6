#include "bus/layers_node.hpp"

#include <algorithm>
#include <utility>

namespace concord {
namespace {

const std::string kStreamPrefix = "out/agent/";
/// Streams and lists are said each second; some of that may be lost.
constexpr std::int64_t kAllHeard = 5'000'000;

}  // namespace

LayersNode::LayersNode(const NodeContext& context) : context_(context), start_(context.bus.now()) {
  listen<BrickPacket>(context_.bus, context_.counters, context_.process, kStreamPrefix + "[^/]+/bricks",
                      [this](const std::string& channel, const BrickPacket& packet) {
                        if (BrickReceiver* stream = stream_of_channel(channel, true)) stream->on_packet(packet);
                      });
  listen<BrickDigest>(context_.bus, context_.counters, context_.process, kStreamPrefix + "[^/]+/digest",
                      [this](const std::string& channel, const BrickDigest& digest) {
                        // Who was removed before this start need not become known to be gone.
                        const bool may_begin = !digest.frame_id.empty();
                        if (BrickReceiver* stream = stream_of_channel(channel, may_begin)) stream->on_digest(digest);
                      });
  listen<AgentList>(context_.bus, context_.counters, context_.process, "out/agents",
                    [this](const std::string&, const AgentList& list) { on_agents(list); });
}

bool LayersNode::settled() const {
  if (context_.bus.now() - start_ > kAllHeard) return true;
  return list_ && std::ranges::all_of(list_->agents, [this](const AgentState& agent) {
           return agent.revision == 0 || layers_.contains(agent.id);
         });
}

std::optional<bool> LayersNode::map_is_founded() const {
  if (!list_) return std::nullopt;
  return std::ranges::any_of(list_->agents, &AgentState::aligned);
}

/// Null if there is none and none may begin, there is no room for one more, or none can have this name.
BrickReceiver* LayersNode::stream_of_channel(const std::string& channel, bool may_begin) {
  const std::string id = channel.substr(kStreamPrefix.size(), channel.rfind('/') - kStreamPrefix.size());
  const auto it = streams_.find(id);
  if (it != streams_.end()) return it->second.get();
  if (!may_begin) return nullptr;
  if (!is_name(id) || streams_.size() >= static_cast<std::size_t>(context_.site.ingest.max_agents)) {
    context_.counters.refused(channel, {Code::kBadName, "no room for an agent of this name"});
    return nullptr;
  }
  return (streams_[id] = make_receiver(id)).get();
}

std::unique_ptr<BrickReceiver> LayersNode::make_receiver(const std::string& id) {
  BrickReceiver::Events events;
  events.on_frame = [this, id](const std::string& frame_id) {
    AgentLayer& layer = layers_[id] = {};  // a transform holds for the frame it was found in
    layer.frame_id = frame_id;
    if (list_) place(id, layer, *list_);  // or it would lie nowhere until the next list
  };
  events.on_brick = [this, id](BrickIndex index, Brick brick) { layers_[id].map.set(index, std::move(brick)); };
  events.on_end = [this, id] { layers_.erase(id); };
  return std::make_unique<BrickReceiver>(context_.bus, context_.counters,
                                         BrickReceiver::Config{kStreamPrefix + id, context_.site.resolution},
                                         std::move(events));
}

void LayersNode::place(const std::string& id, AgentLayer& layer, const AgentList& list) {
  const auto state = std::ranges::find(list.agents, id, &AgentState::id);
  const bool is_placed = state != list.agents.end() && state->aligned && state->frame_id == layer.frame_id;
  layer.T_map_agent = is_placed ? std::optional(state->T_map_agent) : std::nullopt;
  if (state != list.agents.end()) layer.weight = state->weight;
}

void LayersNode::on_agents(const AgentList& list) {
  list_ = list;
  for (auto& [id, layer] : layers_) place(id, layer, list);
}

const AgentLayers& LayersNode::now() {
  // Not while a stream says that it has ended: it is in use then.
  std::erase_if(streams_, [](const auto& entry) { return entry.second->heard() && entry.second->frame_id().empty(); });
  for (auto& [id, layer] : layers_) {
    const BrickReceiver& stream = *streams_.at(id);
    layer.revision = stream.revision();
    layer.synced = stream.synced();
  }
  return layers_;
}

}  // namespace concord
