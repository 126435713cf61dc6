// Requests about agents: who is there, where they lie, how much they count.

#include "bridge/requests.hpp"

namespace concord::hmd {
namespace {

void end_agent(Desk& desk, const Ask& ask, const std::string& agent, AgentRequest::Op op) {
  const AgentRequest request{desk.id(ask), agent, op};
  const Bytes message = encode(request, desk.now());
  if (op == AgentRequest::Op::kReset) {
    desk.forward(ask, "in/agent_request", message, [](const Answer&) { return ResetAnswer{}; });
  } else {
    desk.forward(ask, "in/agent_request", message, [](const Answer&) { return RemoveAnswer{}; });
  }
}

Code robot_code(const std::string& code) {
  if (code == "NO_AGENT") return Code::kNoRobot;
  if (code == "STALE") return Code::kStaleStamp;
  return code_of(code);
}

/// A detection worse than this says too little of where the robot is.
constexpr double kMaxSigma = 0.3;  // metres
constexpr double kMaxAngle = 15 * 3.14159265 / 180;

}  // namespace

void work_on(Desk& desk, const Ask& ask, const AgentsRequest& /*request*/) {
  AgentsAnswer answer;
  for (const auto& [id, state] : desk.world.agents()) {
    if (answer.agents.size() < 1000) answer.agents.push_back(to_hmd(state));
  }
  desk.hub.answer(ask, answer);
}

void work_on(Desk& desk, const Ask& ask, const ResetRequest& request) {
  end_agent(desk, ask, request.agent, AgentRequest::Op::kReset);
}
void work_on(Desk& desk, const Ask& ask, const RemoveRequest& request) {
  end_agent(desk, ask, request.agent, AgentRequest::Op::kRemove);
}

void work_on(Desk& desk, const Ask& ask, const WeightRequest& request) {
  if (request.weight < 1 || request.weight > 1000)
    return desk.hub.refuse(ask, Code::kBadRequest, "a weight is 1 to 1000");
  const concord::WeightRequest weight{desk.id(ask), desk.author(ask), request.agent, request.weight, desk.now()};
  desk.forward(ask, "in/weight", encode(weight), [](const Answer& answer) { return WeightAnswer{answer.revision}; });
}

void work_on(Desk& desk, const Ask& ask, const PlaceRequest& request) {
  const auto T = from_hmd(request.T_map_agent);
  if (!T) return desk.refuse(ask, {code_of(T.error()), T.error().message});
  const AgentState* state = desk.world.agent(request.agent);
  const std::string frame_id = state != nullptr ? state->frame_id : "";
  const std::pair key{ask.session, request.agent};
  const auto before = state != nullptr && state->aligned ? std::optional(state->T_map_agent) : std::nullopt;
  const TransformRequest transform{desk.id(ask), desk.author(ask), request.agent, frame_id, *T, desk.now()};
  desk.forward(ask, "in/transform", encode(transform, desk.now()),
               [&desk, key, before, frame_id, T = *T](const Answer& answer) {
                 desk.placed.erase(key);
                 if (before) desk.placed.insert_or_assign(key, Desk::Placed{frame_id, *before, T});
                 return PlaceAnswer{answer.revision};
               });
}

void work_on(Desk& desk, const Ask& ask, const AlignUndoRequest& request) {
  const auto it = desk.placed.find({ask.session, request.agent});
  if (it == desk.placed.end())
    return desk.hub.refuse(ask, Code::kExpired, "this session has not moved it from another place");
  const AgentState* state = desk.world.agent(request.agent);
  if (state == nullptr) return desk.hub.refuse(ask, Code::kNoAgent, "no agent is called " + request.agent);
  const Desk::Placed placed = it->second;
  if (state->frame_id != placed.frame_id || !state->aligned || !state->T_map_agent.isApprox(placed.after, 1e-9)) {
    desk.placed.erase(it);
    return desk.hub.refuse(ask, Code::kExpired, "it was moved since, or began a new frame");
  }
  const TransformRequest transform{desk.id(ask),    desk.author(ask), request.agent,
                                   placed.frame_id, placed.before,    desk.now()};
  desk.forward(ask, "in/transform", encode(transform, desk.now()),
               [&desk, key = std::pair{ask.session, request.agent}, placed](const Answer& answer) {
                 desk.placed.erase(key);
                 return AlignUndoAnswer{to_hmd(placed.before), answer.revision};
               });
}

void work_on(Desk& desk, const Ask& ask, const RobotCorrectRequest& request) {
  const auto where = desk.place(ask, request.frame);
  if (!where) return desk.refuse(ask, where.error());
  const auto T = from_hmd(request.T_frame_base);
  if (!T) return desk.refuse(ask, {code_of(T.error()), T.error().message});
  if (request.covariance) {
    for (std::size_t i = 0; i < 6; ++i) {
      const double variance = (*request.covariance)[i], most = i < 3 ? kMaxSigma : kMaxAngle;
      if (variance < 0 || variance > most * most) {
        return desk.hub.refuse(ask, Code::kRejected,
                               "the detection is too uncertain: over 0.3 m or 15 degrees; go nearer");
      }
    }
  }
  const LocaliseRequest localise{desk.id(ask), desk.author(ask), request.robot, *T, where->frame, request.utime};
  desk.forward(
      ask, "in/localise", encode(localise),
      [T_map_base = where->T_map_frame * *T](const Answer& answer) {
        return RobotCorrectAnswer{to_hmd(T_map_base), answer.revision};
      },
      robot_code);
}

void work_on(Desk& desk, const Ask& ask, const RobotPoseRequest& request) {
  const AgentState* state = desk.world.agent(request.robot);
  if (state == nullptr) return desk.hub.refuse(ask, Code::kNoRobot, "no robot is called " + request.robot);
  if (!state->aligned) return desk.hub.refuse(ask, Code::kUnaligned, "where it is in the map is not known");
  const World::SeenPose* pose = desk.world.pose(request.robot);
  if (pose == nullptr || desk.world.stale(*pose))
    return desk.hub.refuse(ask, Code::kStale, "it has not said for 2 s where it is");
  desk.hub.answer(ask, RobotPoseAnswer{to_hmd(pose->T_map_base), pose->utime});
}

}  // namespace concord::hmd
