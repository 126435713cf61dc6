#include "cli/demo_watch.hpp"

#include <algorithm>

namespace concord {

DemoWatch::DemoWatch(Live& live) {
  live.hear<ProcessStatus>("out/status/.*",
                           [this](const std::string&, ProcessStatus s) { statuses_[s.process] = std::move(s); });
  live.hear<AgentList>("out/agents", [this](const std::string&, AgentList list) { agents_ = std::move(list.agents); });
}

void DemoWatch::publish(Live& live, const DemoAgent& agent) {
  published_[agent.id] = std::make_unique<PublishedMap>(live, agent.id, "file", *agent.file);
}

std::optional<std::string> DemoWatch::anyone() const {
  return statuses_.empty() ? std::nullopt : std::optional(statuses_.begin()->first);
}

const AgentState* DemoWatch::state_of(const std::string& id) const {
  const auto state = std::ranges::find(agents_, id, &AgentState::id);
  return state != agents_.end() ? &*state : nullptr;
}

void DemoWatch::note_aligned(const std::string& id) {
  for (AgentState& state : agents_) state.aligned = state.aligned || state.id == id;
}

std::int64_t DemoWatch::progress(const DemoAgent& agent) const {
  if (!agent.file) return counter(agent, "progress_percent");
  const AgentState* state = state_of(agent.id);
  return state == nullptr ? 0 : 100 * state->known / published_.at(agent.id)->known();
}

bool DemoWatch::finished(const DemoAgent& agent) const {
  const AgentState* state = state_of(agent.id);
  if (state == nullptr || !state->aligned || !state->synced) return false;
  return agent.file ? published_.at(agent.id)->arrived() : progress(agent) >= 100;
}

std::int64_t DemoWatch::bytes_sent(const DemoAgent& agent) const {
  return agent.file ? published_.at(agent.id)->bytes_sent() : counter(agent, "bytes_sent");
}

std::int64_t DemoWatch::counter(const DemoAgent& agent, const std::string& name) const {
  const auto status = statuses_.find("sim-" + agent.id);
  if (status == statuses_.end()) return 0;
  const auto value = status->second.counters.find(name);
  return value != status->second.counters.end() ? value->second : 0;
}

}  // namespace concord
