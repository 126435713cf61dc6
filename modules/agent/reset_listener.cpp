#include "agent/reset_listener.hpp"

#include "bus/messages.hpp"

namespace concord {

ResetListener::ResetListener(Bus& bus, Counters& counters, const std::string& agent, std::function<void()> on_reset)
    : state_(std::make_shared<State>(State{agent, std::move(on_reset), {}})) {
  // Not `listen`: ingest answers such requests, a second answer would contradict it.
  bus.subscribe("in/agent_request", [&counters, weak = std::weak_ptr(state_)](const std::string& channel, auto bytes) {
    const std::shared_ptr<State> state = weak.lock();
    if (!state) return;
    const Decoded<AgentRequest> request = decode<AgentRequest>(bytes);
    if (!request) return counters.refused(channel, request.error().error);
    const bool ours = request->agent == state->agent && request->op == AgentRequest::Op::kReset;
    if (!ours || request->id == state->last_id) return;
    state->last_id = request->id;
    state->on_reset();
  });
}

}  // namespace concord
