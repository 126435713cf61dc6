#include "ingest/ingest_node.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <spdlog/spdlog.h>

namespace concord {
namespace {

/// What changed is gathered for a while, because the same bricks change again and again; then it is written in slices,
/// because messages wait meanwhile.
constexpr std::int64_t kGatherPeriod = 2'000'000;
constexpr std::int64_t kSlicePeriod = 50'000;
constexpr std::int64_t kSayOverPeriod = 1'000'000;
/// What was refused for want of room is asked for when there is this much, so that it is not asked for all the time.
constexpr double kRoomAgain = 0.1;
constexpr std::int64_t kCountPeriod = 1'000'000;
/// A brick stream speaks each second while its sender lives.
constexpr std::int64_t kStreamSilence = 3'000'000;
/// Ids that never send anything good have a receiver too, until they are silent.
constexpr std::size_t kMaxReceivers = 2000;
/// Of these, for ids that are known: strangers must not shut them out.
constexpr std::size_t kReceiversForKnown = 1000;
constexpr std::int64_t kMostLostCounted = 1'000'000;  // a hostile number must not overflow a sum

/// AGENT of `in/AGENT/...`.
std::string agent_of(const std::string& channel) {
  const std::size_t begin = channel.find('/') + 1;
  return channel.substr(begin, channel.find('/', begin) - begin);
}

Ingest::Config config_of(const NodeContext& context) {
  const Site& site = context.site;
  return {site.resolution, site.ingest.max_agents, site.ingest.max_known_voxels, context.boot_id};
}

}  // namespace

IngestNode::IngestNode(const NodeContext& context)
    : bus_(context.bus),
      counters_(context.counters),
      site_(context.site),
      process_(context.process),
      ingest_(config_of(context)),
      store_(context.site.state / "ingest.db", context.site.resolution),
      streams_(context.bus, context.counters, context.site.resolution, context.site.stream.bytes_per_second,
               LayerStore::kMaxRemoved),
      replies_(context.bus, context.site.stream.bytes_per_second),
      answers_(context.bus) {
  restore();
  subscribe();
}

IngestNode::~IngestNode() {
  if (auto done = store_.flush(ingest_.agents()); !done) counters_.refused("disk", done.error());
}

void IngestNode::restore() {
  auto loaded = store_.load();
  if (!loaded) throw std::runtime_error(loaded.error().message);
  for (const auto& [id, error] : loaded->refused) counters_.refused("disk." + id, error);
  for (const std::string& id : loaded->removed) streams_.end(id);
  for (auto& [id, stored] : loaded->agents) {
    const Change change = ingest_.put(id, std::move(stored));
    const Agent& agent = *ingest_.find(id);
    streams_.tell(id, agent, change);
    spdlog::info("{}: {} voxels in frame {} from disk", id, agent.known(), agent.frame_id);
    if (agent.source != Source::kStream || !ingest_.admit(id, agent.frame_id, Source::kStream)) continue;
    const Input& input = inputs_.emplace(id, Input{make_receiver(id), bus_.now()}).first->second;
    input.receiver->adopt(agent.frame_id, agent.layer);
  }
}

void IngestNode::subscribe() {
  const auto hear = [&]<class T>(const char* channel_regex, void (IngestNode::*handle)(const std::string&, const T&)) {
    listen<T>(bus_, counters_, process_, channel_regex,
              [this, handle](const std::string& channel, const T& message) { (this->*handle)(channel, message); });
  };
  hear("in/[^/]+/bricks", &IngestNode::on_packet);
  hear("in/[^/]+/digest", &IngestNode::on_digest);
  hear("in/[^/]+/octomap", &IngestNode::on_octomap);
  hear("in/[^/]+/cloud", &IngestNode::on_cloud);
  hear("in/agent_request", &IngestNode::on_agent_request);
  hear("in/map_request", &IngestNode::on_map_request);
  hear("out/answer", &IngestNode::on_answer);
  hear("in/downsample", &IngestNode::on_downsample);
  bus_.every(kSlicePeriod, [this] { write_some(); });
  bus_.every(kCountPeriod, [this] {
    count();
    ask_again_where_there_is_room();
    forget_silent_strangers();
  });
}

/// The core's rules, and one that hangs on time.
Result<void> IngestNode::admit(const std::string& id, const std::string& frame_id, Source source) const {
  if (auto ok = ingest_.admit(id, frame_id, source); !ok) return ok;
  const Agent* agent = ingest_.find(id);
  const auto input = inputs_.find(id);
  const bool streaming = agent != nullptr && agent->source == Source::kStream && input != inputs_.end() &&
                         bus_.now() - input->second.last_heard < kStreamSilence;
  if (streaming && source != Source::kStream) {
    return refuse(Code::kBadRequest, id + " sends a brick stream; end that sender first, or use another agent id");
  }
  return {};
}

/// Counts what is refused. Who sends in a frame that is over is told so: the first message may have been lost.
bool IngestNode::admitted(const std::string& channel, const std::string& frame_id, Source source) {
  const std::string id = agent_of(channel);
  const auto ok = admit(id, frame_id, source);
  if (ok) return true;
  counters_.refused(channel, ok.error());
  if (ingest_.is_over(id, frame_id)) say_frame_over(id, frame_id);
  return false;
}

void IngestNode::say_frame_over(const std::string& id, const std::string& frame_id) {
  std::int64_t& last = said_over_[id];
  if (bus_.now() - last < kSayOverPeriod) return;
  last = bus_.now();
  bus_.publish("out/frame_over/" + id, encode(FrameOver{last, frame_id}));
}

BrickReceiver* IngestNode::receiver_of(const std::string& channel, const std::string& frame_id) {
  if (!admitted(channel, frame_id, Source::kStream)) return nullptr;
  const std::string id = agent_of(channel);
  auto it = inputs_.find(id);
  if (it == inputs_.end()) {
    const bool is_known = ingest_.find(id) != nullptr || site_.agents.contains(id);
    if (inputs_.size() >= kMaxReceivers - (is_known ? 0 : kReceiversForKnown)) {
      counters_.refused(channel, {Code::kTooLarge, "too many ids send at once; name this one in the site file"});
      return nullptr;
    }
    it = inputs_.emplace(id, Input{make_receiver(id), 0}).first;
  }
  it->second.last_heard = bus_.now();
  return it->second.receiver.get();
}

std::unique_ptr<BrickReceiver> IngestNode::make_receiver(const std::string& id) {
  BrickReceiver::Events events;
  events.on_frame = [this, id](const std::string& frame_id) {
    const auto change = ingest_.begin_stream(id, frame_id);
    if (!change) return counters_.refused("in/" + id, change.error());
    inputs_.at(id).lacking = false;
    spdlog::info("{}: frame {} begins", id, frame_id);
    changed(id, *change);
  };
  events.on_brick = [this, id](BrickIndex index, Brick brick) {
    const auto changes = ingest_.set_brick(id, index, std::move(brick));
    if (!changes) {
      inputs_.at(id).lacking = true;
      return counters_.refused("in/" + id, changes.error());
    }
    if (!*changes) return;
    store_.note(id, index);
    streams_.touch(id, index);
  };
  const BrickReceiver::Config config{.stream = "in/" + id, .resolution = site_.resolution};
  return std::make_unique<BrickReceiver>(bus_, counters_, config, std::move(events));
}

void IngestNode::on_packet(const std::string& channel, const BrickPacket& packet) {
  counters_.add("bytes_in", static_cast<std::int64_t>(packet.data.size()));
  BrickReceiver* receiver = receiver_of(channel, packet.frame_id);
  if (receiver != nullptr) receiver->on_packet(packet);
}

void IngestNode::on_digest(const std::string& channel, const BrickDigest& digest) {
  if (digest.frame_id.empty()) return;  // the sender has ended; what it sent stays
  BrickReceiver* receiver = receiver_of(channel, digest.frame_id);
  if (receiver != nullptr) receiver->on_digest(digest);
}

void IngestNode::on_octomap(const std::string& channel, const OctomapMessage& message) {
  counters_.add("bytes_in", static_cast<std::int64_t>(message.data.size()));
  if (!admitted(channel, message.frame_id, Source::kOctomap)) return;
  const std::string id = agent_of(channel);
  const OctomapFormat format = message.binary ? OctomapFormat::kBinary : OctomapFormat::kFull;
  const auto change = ingest_.take_octomap(id, message.frame_id, message.data, format, message.resolution);
  if (!change) return counters_.refused(channel, change.error());
  inputs_.erase(id);
  changed(id, *change);
}

void IngestNode::on_cloud(const std::string& channel, const CloudMessage& message) {
  counters_.add("bytes_in", static_cast<std::int64_t>(message.points.size() * sizeof(Eigen::Vector3f)));
  if (!admitted(channel, message.frame_id, Source::kClouds)) return;
  const std::string id = agent_of(channel);
  Scan scan{message.T_agent_sensor, message.max_range, message.points};
  const CloudNumber number{message.boot_id, message.sequence};
  const auto taken = ingest_.take_cloud(id, message.frame_id, number, std::move(scan), bus_.now());
  if (!taken) return counters_.refused(channel, taken.error());
  if (taken->duplicate) return counters_.add("duplicates." + id);
  if (taken->lost > 0) counters_.add("gaps." + id, std::min(taken->lost, kMostLostCounted));
  if (taken->skipped > 0) counters_.add("points_skipped", static_cast<std::int64_t>(taken->skipped));
  inputs_.erase(id);
  changed(id, taken->change);
}

void IngestNode::changed(const std::string& id, const Change& change) {
  const Agent& agent = *ingest_.find(id);
  wrote(store_.introduce(id, agent));
  store_.note(id, agent, change);
  streams_.tell(id, agent, change);
}

void IngestNode::write_some() {
  if (bus_.now() < write_at_) return;
  const auto done = store_.write_some(ingest_.agents());
  wrote(done);
  if (!done || store_.is_idle()) write_at_ = bus_.now() + kGatherPeriod;
}

/// Who publishes is told by `disk_fails` that what was sent would not outlive this process.
void IngestNode::wrote(const Result<void>& done) {
  if (!done) counters_.refused("disk", done.error());
  if (!done || counters_.get("disk_fails") != 0) counters_.set("disk_fails", done ? 0 : 1);
}

void IngestNode::count() {
  counters_.set("agents", static_cast<std::int64_t>(ingest_.agents().size()));
  counters_.set("agents_to_write", static_cast<std::int64_t>(store_.to_write()));
  for (const auto& [id, agent] : ingest_.agents()) counters_.set("known." + id, agent.known());
  for (const auto& [id, input] : inputs_) {
    if (input.lacking || counters_.get("lacking." + id) != 0) counters_.set("lacking." + id, input.lacking ? 1 : 0);
  }
}

/// A receiver that begins anew from the layer finds that the sender has more, and asks for it.
void IngestNode::ask_again_where_there_is_room() {
  const auto enough = static_cast<std::int64_t>((1 - kRoomAgain) * static_cast<double>(site_.ingest.max_known_voxels));
  for (auto& [id, input] : inputs_) {
    const Agent* agent = ingest_.find(id);
    if (!input.lacking || agent == nullptr || agent->known() > enough) continue;
    input.receiver = make_receiver(id);
    input.receiver->adopt(agent->frame_id, agent->layer);
    input.lacking = false;
  }
}

/// A receiver without an agent holds nothing that its sender would not send again.
void IngestNode::forget_silent_strangers() {
  std::erase_if(inputs_, [this](const auto& entry) {
    const auto& [id, input] = entry;
    return ingest_.find(id) == nullptr && bus_.now() - input.last_heard >= kStreamSilence;
  });
}

}  // namespace concord
