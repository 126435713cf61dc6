#include "bridge/own_maps.hpp"

#include <algorithm>

#include "bridge/requests.hpp"

namespace concord::hmd {
namespace {

constexpr std::int64_t kPublish = 500'000;  // microseconds
constexpr std::int64_t kPoses = 100'000;
constexpr std::int64_t kSilent = 5'000'000;  ///< after so long nobody else speaks for an agent any more
constexpr std::size_t kMostOthers = 1000;

Code upload_code(const Error& error) {
  if (error.code == concord::Code::kStale) return Code::kDupSeq;
  if (error.code == concord::Code::kMalformed || error.code == concord::Code::kNotFinite) return Code::kBadMessage;
  return code_of(error);
}

}  // namespace

OwnMaps::Own::Own(const NodeContext& context, const std::string& agent)
    : mapper(context.site.resolution),
      boot_id(context.bus.now()),
      sender(context.bus, context.counters,
             {.stream = "in/" + agent,
              .resolution = context.site.resolution,
              .bytes_per_second = context.site.stream.bytes_per_second,
              .boot_id = boot_id},
             mapper.map()) {}

OwnMaps::OwnMaps(Desk& desk) : desk_(desk) {
  const NodeContext& context = desk_.context;
  listen<FrameOver>(context.bus, context.counters, context.process, "out/frame_over/.*",
                    [this](const std::string& channel, const FrameOver& over) {
                      const auto it = by_agent_.find(channel.substr(std::string("out/frame_over/").size()));
                      if (it != by_agent_.end()) it->second->over = over.frame_id;
                    });
  hear_others();
  context.bus.every(kPublish, [this] {
    for (auto& [agent, own] : by_agent_) {
      if (own->dirty) publish(*own);
    }
  });
}

/// Our own messages come back to us, too: a stream of ours is known by its boot_id, and poses of an agent that we speak
/// for are taken for ours.
void OwnMaps::hear_others() {
  const NodeContext& context = desk_.context;
  listen<BrickDigest>(context.bus, context.counters, context.process, "in/.*/digest",
                      [this](const std::string& channel, const BrickDigest& digest) {
                        const std::string agent = channel.substr(3, channel.rfind('/') - 3);
                        const auto own = by_agent_.find(agent);
                        if (own == by_agent_.end() || own->second->boot_id != digest.boot_id) heard_other(agent);
                      });
  listen<AgentPose>(context.bus, context.counters, context.process, "in/.*/pose",
                    [this](const std::string& channel, const AgentPose&) {
                      const std::string agent = channel.substr(3, channel.rfind('/') - 3);
                      if (!by_agent_.contains(agent)) heard_other(agent);
                    });
}

void OwnMaps::heard_other(const std::string& agent) {
  const std::int64_t now = desk_.now();
  if (others_.size() >= kMostOthers) std::erase_if(others_, [now](const auto& e) { return now - e.second > kSilent; });
  if (others_.size() < kMostOthers || others_.contains(agent)) others_[agent] = now;
}

std::optional<std::string> OwnMaps::not_for_clients(const std::string& agent, Role role) const {
  const Site& site = desk_.context.site;
  const std::string& kind = site.agent(agent).kind;
  const bool unknown = !site.agents.contains(agent) && kind == AgentConfig().kind;
  if (kind != "headset" && !unknown && !may(role, Role::kRobot))
    return "the site file has this agent as " + kind + ": that takes the role robot, or another name";
  const auto other = others_.find(agent);
  if (other != others_.end() && desk_.now() - other->second < kSilent)
    return "another process speaks for this agent; choose another name";
  return std::nullopt;
}

OwnMaps::Own* OwnMaps::own_of(const std::string& agent) {
  if (const auto it = by_agent_.find(agent); it != by_agent_.end()) return it->second.get();
  if (by_agent_.size() >= kMost) {
    const auto oldest = std::min_element(by_agent_.begin(), by_agent_.end(),
                                         [](const auto& a, const auto& b) { return a.second->used < b.second->used; });
    by_agent_.erase(oldest);
  }
  return by_agent_.emplace(agent, std::make_unique<Own>(desk_.context, agent)).first->second.get();
}

void OwnMaps::begin(const Session& session, bool resumed) {
  if (session.agent.empty() || resumed) return;
  if (const auto it = by_agent_.find(session.agent); it != by_agent_.end()) it->second->mapper.end_sequence();
}

/// Its pose makes it an agent that people see and place, also before it has scanned anything.
void OwnMaps::tracking(const Session& session) {
  if (session.agent.empty() || session.tracking_lost || !session.T_own_head) return;
  Own& own = *own_of(session.agent);
  const std::int64_t now = desk_.now();
  if (now - own.pose_sent < kPoses || session.frame_id == own.over) return;
  own.pose_sent = own.used = now;
  const AgentPose pose{session.agent, session.frame_id, *session.T_own_head, now};
  desk_.context.bus.publish("in/" + session.agent + "/pose", encode(pose));
}

Granted<OwnMaps::Own*> OwnMaps::open(const Session& session) {
  if (session.agent.empty()) return no(Code::kBadFrame, "this client is no agent; say agent and frame_id in hello");
  if (session.tracking_lost)
    return no(Code::kTrackingLost, "the device does not know where it is; look around until it does");
  Own* own = own_of(session.agent);
  if (own->over == session.frame_id) return no(Code::kBadFrame, "this frame was reset; begin another frame_id");
  own->used = desk_.now();
  if (own->frame_id != session.frame_id) {
    own->mapper = RoomMapper(desk_.context.site.resolution);
    own->frame_id = session.frame_id;
    own->dirty = false;
    if (own->begun) own->sender.begin(own->frame_id);
  }
  return own;
}

void OwnMaps::upload(const Ask& ask, const BinaryFrame& frame) {
  const auto opened = open(*desk_.hub.find(ask.session));
  if (!opened) return desk_.refuse(ask, opened.error());
  Own& own = **opened;
  const std::int64_t sequence = frame.head.revision;
  Result<void> taken;
  if (frame.head.kind == FrameKind::kMesh) {
    const auto look = read_mesh(frame);
    taken = look ? own.mapper.take(*look, sequence) : tl::unexpected(look.error());
  } else {
    const auto look = read_voxels(frame);
    taken = look ? own.mapper.take(*look, sequence) : tl::unexpected(look.error());
  }
  if (!taken) return desk_.hub.refuse(ask, upload_code(taken.error()), taken.error().message);
  own.dirty = true;
  if (frame.head.kind == FrameKind::kMesh) {
    desk_.hub.answer(ask, UploadMeshAnswer{sequence, own.mapper.occupied()});
  } else {
    desk_.hub.answer(ask, UploadVoxelsAnswer{sequence, own.mapper.occupied()});
  }
}

void OwnMaps::publish(Own& own) {
  own.dirty = false;
  if (!own.begun) {
    if (own.mapper.map().brick_count() == 0) return;
    own.sender.begin(own.frame_id);
    own.begun = true;
  }
  for (const BrickIndex index : own.mapper.take_changed()) own.sender.touch(index);
  own.sender.send_now();
}

void OwnMaps::send_map(const Ask& ask, const SendMapRequest& request) {
  const auto opened = open(*desk_.hub.find(ask.session));
  if (!opened) return desk_.refuse(ask, opened.error());
  Own& own = **opened;
  if (own.mapper.occupied() == 0)
    return desk_.hub.refuse(ask, Code::kEmpty, "nothing was scanned yet: look around, a wall needs two looks");
  publish(own);
  if (request.final) own.mapper.end_sequence();
  desk_.hub.answer(
      ask, SendMapAnswer{own.mapper.occupied(), own.mapper.known() - own.mapper.occupied(), own.sender.revision()});
}

}  // namespace concord::hmd
