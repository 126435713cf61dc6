#include "bridge/own_maps.hpp"

#include <algorithm>

#include "bridge/requests.hpp"

namespace concord::hmd {
namespace {

constexpr std::int64_t kPublish = 500'000;  // microseconds
constexpr std::int64_t kPoses = 100'000;

Code upload_code(const Error& error) {
  if (error.code == concord::Code::kStale) return Code::kDupSeq;
  if (error.code == concord::Code::kMalformed || error.code == concord::Code::kNotFinite) return Code::kBadMessage;
  return code_of(error);
}

}  // namespace

OwnMaps::Own::Own(const NodeContext& context, const std::string& agent)
    : mapper(context.site.resolution),
      sender(context.bus, context.counters,
             {.stream = "in/" + agent,
              .resolution = context.site.resolution,
              .bytes_per_second = context.site.stream.bytes_per_second,
              .boot_id = context.bus.now()},
             mapper.map()) {}

OwnMaps::OwnMaps(Desk& desk) : desk_(desk) {
  const NodeContext& context = desk_.context;
  listen<FrameOver>(context.bus, context.counters, context.process, "out/frame_over/.*",
                    [this](const std::string& channel, const FrameOver& over) {
                      const auto it = by_agent_.find(channel.substr(std::string("out/frame_over/").size()));
                      if (it != by_agent_.end()) it->second->over = over.frame_id;
                    });
  context.bus.every(kPublish, [this] {
    for (auto& [agent, own] : by_agent_) {
      if (own->dirty) publish(*own);
    }
  });
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
    own->sender.begin(own->frame_id);
    own->dirty = false;
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
  for (const BrickIndex index : own.mapper.take_changed()) own.sender.touch(index);
  own.sender.send_now();
  own.dirty = false;
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
