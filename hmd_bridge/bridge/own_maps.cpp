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
    : mapper(std::make_shared<RoomMapper>(context.site.resolution)),
      boot_id(context.bus.now()),
      sender(context.bus, context.counters,
             {.stream = "in/" + agent,
              .resolution = context.site.resolution,
              .bytes_per_second = context.site.stream.bytes_per_second,
              .boot_id = boot_id},
             map) {}

OwnMaps::OwnMaps(Desk& desk, std::launch how, const MapLimits& limits)
    : desk_(desk), judge_(desk.context.bus, how), limits_(limits) {
  const NodeContext& context = desk_.context;
  listen<FrameOver>(context.bus, context.counters, context.process, "out/frame_over/.*",
                    [this](const std::string& channel, const FrameOver& over) {
                      const auto it = by_agent_.find(channel.substr(std::string("out/frame_over/").size()));
                      if (it != by_agent_.end()) it->second->over = over.frame_id;
                    });
  hear_others();
  context.bus.every(kPublish, [this] {
    for (auto& [agent, own] : by_agent_) {
      if (!own->changed.empty()) publish(*own);
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

std::shared_ptr<OwnMaps::Own> OwnMaps::own_of(const Session& session) {
  auto it = by_agent_.find(session.agent);
  if (it == by_agent_.end()) {
    if (!leave(room_for_agent(held(), session.identity.name, limits_))) return nullptr;
    it = by_agent_.emplace(session.agent, std::make_shared<Own>(desk_.context, session.agent)).first;
  }
  it->second->identity = session.identity.name;
  return it->second;
}

std::vector<HeldMap> OwnMaps::held() const {
  std::set<std::string> spoken_for;
  for (const auto& [number, session] : desk_.hub.sessions()) spoken_for.insert(session.agent);
  std::vector<HeldMap> held;
  for (const auto& [agent, own] : by_agent_) {
    const std::size_t bytes = own->mapper_bytes + own->map.brick_count() * RoomMapper::kBrickBytes;
    held.push_back({agent, own->identity, bytes, own->used, spoken_for.contains(agent)});
  }
  return held;
}

bool OwnMaps::leave(const Leaving& leaving) {
  if (!leaving) return false;
  for (const std::string& agent : *leaving) by_agent_.erase(agent);
  return true;
}

void OwnMaps::begin(const Session& session, bool resumed) {
  if (session.agent.empty() || resumed) return;
  if (const auto it = by_agent_.find(session.agent); it != by_agent_.end()) it->second->anew = true;
}

/// Its pose makes it an agent that people see and place, also before it has scanned anything.
void OwnMaps::tracking(const Session& session) {
  if (session.agent.empty() || session.tracking_lost || !session.T_own_head) return;
  const auto found = own_of(session);
  if (!found) return;  // its first look is told why
  Own& own = *found;
  const std::int64_t now = desk_.now();
  if (now - own.pose_sent < kPoses || session.frame_id == own.over) return;
  own.pose_sent = own.used = now;
  const AgentPose pose{session.agent, session.frame_id, *session.T_own_head, now};
  desk_.context.bus.publish("in/" + session.agent + "/pose", encode(pose));
}

Granted<std::shared_ptr<OwnMaps::Own>> OwnMaps::open(const Session& session) {
  if (session.agent.empty()) return no(Code::kBadFrame, "this client is no agent; say agent and frame_id in hello");
  if (session.tracking_lost)
    return no(Code::kTrackingLost, "the device does not know where it is; look around until it does");
  const std::shared_ptr<Own> own = own_of(session);
  if (!own) return no(Code::kBusy, "as many agents scan as can be; ask again when one has gone");
  if (own->over == session.frame_id) return no(Code::kBadFrame, "this frame was reset; begin another frame_id");
  own->used = desk_.now();
  if (own->frame_id != session.frame_id) {
    own->mapper = std::make_shared<RoomMapper>(desk_.context.site.resolution);
    own->frame_id = session.frame_id;
    own->map = BrickMap();
    own->mapper_bytes = 0;
    own->changed.clear();
    own->occupied = 0;
    own->anew = false;
    if (own->begun) own->sender.begin(own->frame_id);
  }
  return own;
}

void OwnMaps::upload(const Ask& ask, PackedFrame frame) {
  const Session& session = *desk_.hub.find(ask.session);
  const auto opened = open(session);
  if (!opened) return desk_.refuse(ask, opened.error());
  const std::shared_ptr<Own>& own = *opened;
  LookJudge::Look look{session.agent, own->mapper, own->anew, std::move(frame), {}, {}};
  look.on_brick = [own, mapper = own->mapper](BrickIndex index, Brick brick) {
    if (own->mapper != mapper) return;  // its frame is over
    own->map.set(index, std::move(brick));
    own->changed.insert(index);
  };
  look.on_end = [this, ask, own, mapper = own->mapper, head = look.frame.head](const Judged& judged) {
    if (own->mapper == mapper) own->mapper_bytes = judged.bytes;
    if (!judged.taken) return desk_.hub.refuse(ask, upload_code(judged.taken.error()), judged.taken.error().message);
    const std::int64_t occupied = judged.occupied;
    if (own->mapper == mapper) own->occupied = occupied;
    if (head.kind == FrameKind::kMesh) {
      desk_.hub.answer(ask, UploadMeshAnswer{head.revision, occupied});
    } else {
      desk_.hub.answer(ask, UploadVoxelsAnswer{head.revision, occupied});
    }
  };
  look.has_room = [this, own] {
    if (leave(room_for_look(held(), own->identity, limits_))) return Result<void>();
    return Result<void>(
        refuse(concord::Code::kTooLarge,
               "the maps of all headsets, or of all that are yours, take too much; reset one, or leave"));
  };
  if (!judge_.offer(std::move(look)))
    return desk_.hub.refuse(ask, Code::kRate, "looks before this one are still being judged; offer it again");
  own->anew = false;
}

void OwnMaps::publish(Own& own) {
  if (!own.begun) {
    if (own.map.brick_count() == 0) return own.changed.clear();
    own.sender.begin(own.frame_id);
    own.begun = true;
  }
  for (const BrickIndex index : own.changed) own.sender.touch(index);
  own.changed.clear();
  own.sender.send_now();
}

void OwnMaps::send_map(const Ask& ask, const SendMapRequest& request) {
  const auto opened = open(*desk_.hub.find(ask.session));
  if (!opened) return desk_.refuse(ask, opened.error());
  Own& own = **opened;
  if (own.occupied == 0)
    return desk_.hub.refuse(ask, Code::kEmpty, "nothing was scanned yet: look around, a wall needs two looks");
  publish(own);
  if (request.final) own.anew = true;
  const auto known = static_cast<std::int64_t>(own.map.known_count());
  desk_.hub.answer(ask, SendMapAnswer{own.occupied, known - own.occupied, own.sender.revision()});
}

}  // namespace concord::hmd
