// Requests about alignment: where one agent lies in another's submap, or in the map.

#include <algorithm>
#include <map>
#include <memory>

#include "bridge/requests.hpp"
#include "core/text.hpp"

namespace concord::hmd {
namespace {

constexpr std::int64_t kAlignPatience = 60'000'000;
constexpr std::size_t kMaxKept = 64;  // alignments, as align itself keeps
constexpr std::size_t kMaxRobots = 1000;
constexpr std::int64_t kStale = 2'000'000;

/// What align has said, for one desk.
struct Alignments {
  struct Pose {
    AgentPose pose;
    std::int64_t heard;
  };
  std::map<std::string, AlignResult> results;  ///< by align id
  std::map<std::string, Pose> poses;           ///< of robots in their own frames
};

Alignments& alignments_of(Desk& desk) { return *std::static_pointer_cast<Alignments>(desk.alignments); }

Evidence to_hmd(const concord::Alignment& e) {
  Evidence evidence{e.overlap(), e.rms, e.free_space_violation, e.iterations, e.ms, {}};
  for (const std::string& direction : e.loose) {
    if (evidence.loose.size() < 6) evidence.loose.push_back(cut_to(direction, 80));
  }
  return evidence;
}

void take_result(Desk& desk, AlignResult result) {
  Alignments& all = alignments_of(desk);
  if (all.results.size() >= kMaxKept && !all.results.contains(result.id)) {
    const auto oldest = std::min_element(all.results.begin(), all.results.end(),
                                         [](const auto& a, const auto& b) { return a.second.utime < b.second.utime; });
    all.results.erase(oldest);
  }
  const std::string id = result.id;
  const auto [it, fresh] = all.results.insert_or_assign(id, std::move(result));
  if (it->second.author.empty() && fresh) {  // nobody asked: it is an offer
    const AlignResult& offer = it->second;
    desk.hub.tell_all("alignment/" + offer.source.agent,
                      event_text(AlignmentEvent{offer.source.agent, id, hmd::to_hmd(offer.evidence.T_target_source),
                                                offer.slip, offer.slip_angle, to_hmd(offer.evidence), offer.open}));
  }
  desk.asker.arrived(id);
}

/// Asks align, and hands on what it found; refuses what it refused.
template <class Found>
void ask_align(Desk& desk, const Ask& ask, concord::AlignRequest request, Found found) {
  if (!desk.world.alive("align")) return desk.hub.refuse(ask, Code::kUnavailable, "no process of this stack aligns");
  request.id = desk.id(ask);
  request.author = desk.author(ask);
  request.utime = desk.now();
  const std::string id = request.id;
  Asker::Question question{"in/align", encode(request),
                           id,         [&desk, id] { return alignments_of(desk).results.contains(id); },
                           {},         kAlignPatience};
  desk.asker.ask(std::move(question), [&desk, ask, id, found](const Answer& answer) {
    if (!answer.ok) return desk.hub.refuse(ask, code_of(answer.code), answer.message);
    found(alignments_of(desk).results.at(id));
  });
}

/// The name of the process's codes in an answer about a decision.
Code decision_code(const std::string& code) {
  if (code == "STALE" || code == "CONFLICT" || code == "NOT_FOUND") return Code::kExpired;
  return code_of(code);
}

}  // namespace

void hear_alignments(Desk& desk) {
  desk.alignments = std::make_shared<Alignments>();
  const NodeContext& context = desk.context;
  listen<AlignResult>(context.bus, context.counters, context.process, "out/align",
                      [&desk](const std::string&, AlignResult result) { take_result(desk, std::move(result)); });
  listen<AgentPose>(context.bus, context.counters, context.process, "in/.*/pose",
                    [&desk](const std::string& channel, AgentPose pose) {
                      auto& poses = alignments_of(desk).poses;
                      const std::string agent = channel.substr(3, channel.size() - 3 - std::string("/pose").size());
                      if (poses.size() < kMaxRobots || poses.contains(agent))
                        poses.insert_or_assign(agent, Alignments::Pose{std::move(pose), desk.now()});
                    });
}

void work_on(Desk& desk, const Ask& ask, const AlignRequest& request) {
  concord::AlignRequest align;
  align.source = request.source;
  align.target = request.target.value_or("");
  if (request.T_target_source) {
    const auto T = from_hmd(*request.T_target_source);
    if (!T) return desk.refuse(ask, {code_of(T.error()), T.error().message});
    align.T_target_source = *T;
  }
  ask_align(desk, ask, std::move(align), [&desk, ask](const AlignResult& result) {
    const concord::Alignment& e = result.evidence;
    desk.hub.answer(ask, AlignAnswer{result.id, hmd::to_hmd(e.T_target_source), to_hmd(e), cut_to(e.message, 400)});
  });
}

void work_on(Desk& desk, const Ask& ask, const ReferenceRequest& request) {
  const Session& session = *desk.hub.find(ask.session);
  if (session.agent.empty())
    return desk.hub.refuse(ask, Code::kBadFrame, "this client is no agent; say agent and frame_id in hello");
  if (session.tracking_lost) return desk.hub.refuse(ask, Code::kTrackingLost, "the device does not know where it is");
  const AgentState* robot = desk.world.agent(request.robot);
  if (robot == nullptr) return desk.hub.refuse(ask, Code::kNoRobot, "no robot is called " + request.robot);
  if (robot->known == 0) return desk.hub.refuse(ask, Code::kNoModel, "it has sent no submap to be compared with");
  if (request.robot == session.agent) return desk.hub.refuse(ask, Code::kBadRequest, "that is this device itself");
  const AgentState* own = desk.world.agent(session.agent);
  if (own == nullptr || own->known == 0) {
    return desk.hub.refuse(ask, Code::kNoMap, "this device has sent no submap yet; look around first");
  }
  const auto& poses = alignments_of(desk).poses;
  const auto pose = poses.find(request.robot);
  if (pose == poses.end() || desk.now() - pose->second.heard > kStale ||
      pose->second.pose.frame_id != robot->frame_id) {
    return desk.hub.refuse(ask, Code::kStale, "it has not said for 2 s where it is in its own frame");
  }
  const auto T_own_base = from_hmd(request.T_own_base);
  if (!T_own_base) return desk.refuse(ask, {code_of(T_own_base.error()), T_own_base.error().message});
  const Transform T_agent_base = pose->second.pose.T_agent_base;
  concord::AlignRequest align;
  align.source = session.agent;
  align.source_frame_id = session.frame_id;
  align.target = request.robot;
  align.target_frame_id = robot->frame_id;
  align.T_target_source = T_agent_base * T_own_base->inverse();
  ask_align(desk, ask, std::move(align), [&desk, ask, T_agent_base](const AlignResult& result) {
    const concord::Alignment& e = result.evidence;
    const Transform T_robot_own = T_agent_base.inverse() * e.T_target_source;
    desk.hub.answer(ask, ReferenceAnswer{result.id, hmd::to_hmd(T_robot_own), to_hmd(e), cut_to(e.message, 400)});
  });
}

void work_on(Desk& desk, const Ask& ask, const AlignAcceptRequest& request) {
  const auto& results = alignments_of(desk).results;
  const auto it = results.find(request.align);
  if (it == results.end())
    return desk.hub.refuse(ask, Code::kExpired, "nothing is kept of this alignment; ask for it again");
  const AlignResult& result = it->second;
  const AgentState* target = desk.world.agent(result.target);
  // The first pair founds the map in the target's frame.
  const Transform T_map_target = target != nullptr && target->aligned ? target->T_map_agent : Transform::Identity();
  const Transform T_map_agent = T_map_target * result.evidence.T_target_source;
  const std::string agent = result.source.agent, frame_id = result.source.frame_id;
  const AgentState* state = desk.world.agent(agent);
  if (state == nullptr || state->frame_id != frame_id || state->known == 0)
    return desk.hub.refuse(ask, Code::kBadFrame, "the map of " + agent + " that was aligned is gone; ask again");
  const auto before = state != nullptr && state->aligned ? std::optional(state->T_map_agent) : std::nullopt;
  const AlignDecision decision{desk.id(ask), desk.author(ask), AlignDecision::Op::kAccept, request.align, desk.now()};
  desk.forward(
      ask, "in/align_decision", encode(decision),
      [&desk, key = std::pair{ask.session, agent}, before, frame_id, T_map_agent](const Answer& answer) {
        desk.placed.erase(key);
        if (before) desk.placed.insert_or_assign(key, Desk::Placed{frame_id, *before, T_map_agent});
        return AlignAcceptAnswer{key.second, hmd::to_hmd(T_map_agent), answer.revision};
      },
      decision_code);
}

void work_on(Desk& desk, const Ask& ask, const AlignDropRequest& request) {
  if (!is_request_id(request.align)) return desk.hub.refuse(ask, Code::kExpired, "no alignment has this id");
  const AlignDecision decision{desk.id(ask), desk.author(ask), AlignDecision::Op::kDrop, request.align, desk.now()};
  desk.forward(
      ask, "in/align_decision", encode(decision), [](const Answer&) { return AlignDropAnswer{}; }, decision_code);
}

}  // namespace concord::hmd
