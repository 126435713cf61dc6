#include "cli/demo_watch.hpp"

#include <algorithm>
#include <string_view>

namespace concord {
namespace {

constexpr std::string_view kSim = "sim-";  // before an agent's id: its process

}  // namespace

void LostClouds::note(const ProcessStatus& ingest) {
  constexpr std::string_view kGaps = "gaps.";
  for (const auto& [name, count] : ingest.counters) {
    if (name.starts_with(kGaps)) counts_[name.substr(kGaps.size())][ingest.boot_id] = count;
  }
}

std::int64_t LostClouds::of(const std::string& agent) const {
  const auto counts = counts_.find(agent);
  std::int64_t sum = 0;
  if (counts == counts_.end()) return sum;
  for (const auto& [boot_id, count] : counts->second) sum += count;
  return sum;
}

DemoWatch::DemoWatch(Live& live, const DemoScene& scene) {
  live.hear<ProcessStatus>("out/status/.*", [this](const std::string&, ProcessStatus s) {
    if (s.process == "ingest") lost_.note(s);
    note_done(s);
    statuses_[s.process] = std::move(s);
  });
  live.hear<MapPose>("out/pose/.*", [this](const std::string&, const MapPose& pose) {
    constexpr double kApart = 0.5;
    const Eigen::Vector2d p = pose.T_map_base.translation().head<2>();
    places_[pose.agent] = p;
    const auto track = tracks_.find(pose.agent);
    if (track == tracks_.end()) return;
    if (track->second.empty() || (track->second.back() - p).norm() >= kApart) track->second.push_back(p);
  });
  for (const DemoAgent& agent : scene.agents) {
    tracks_[agent.id];
    Streams& streams = streams_[agent.id];
    live.hear<BrickDigest>(StreamChannels("in/" + agent.id).digest,
                           [&streams](const std::string&, BrickDigest d) { streams.in = std::move(d); });
    live.hear<BrickDigest>(StreamChannels("out/agent/" + agent.id).digest,
                           [&streams](const std::string&, BrickDigest d) { streams.out = std::move(d); });
  }
  live.hear<AgentList>("out/agents", [this](const std::string&, AgentList list) { agents_ = std::move(list.agents); });
}

void DemoWatch::publish(Live& live, const DemoAgent& agent) {
  published_[agent.id] = std::make_unique<PublishedMap>(live, agent.id, "file", *agent.file);
}

void DemoWatch::note_done(const ProcessStatus& status) {
  const auto progress = status.counters.find("progress_percent");
  if (progress == status.counters.end() || !status.process.starts_with(kSim)) return;
  const std::string id = status.process.substr(kSim.size());
  if (progress->second >= 100) {
    done_.try_emplace(id, status.utime);
  } else {
    done_.erase(id);
  }
}

std::optional<std::string> DemoWatch::anyone() const {
  return statuses_.empty() ? std::nullopt : std::optional(statuses_.begin()->first);
}

const AgentState* DemoWatch::state_of(const std::string& id) const {
  const auto state = std::ranges::find(agents_, id, &AgentState::id);
  return state != agents_.end() ? &*state : nullptr;
}

void DemoWatch::note_aligned(const std::string& id, const Transform& T_map_agent) {
  for (AgentState& state : agents_) {
    if (state.id != id) continue;
    state.aligned = true;
    state.T_map_agent = T_map_agent;
  }
}

std::optional<Eigen::Vector2d> DemoWatch::place(const std::string& id) const {
  const auto it = places_.find(id);
  return it != places_.end() ? std::optional(it->second) : std::nullopt;
}

std::int64_t DemoWatch::progress(const DemoAgent& agent) const {
  if (!agent.file) return counter(agent, "progress_percent");
  const AgentState* state = state_of(agent.id);
  return state == nullptr ? 0 : 100 * state->known / published_.at(agent.id)->known();
}

bool DemoWatch::finished(const DemoAgent& agent) const {
  const AgentState* state = state_of(agent.id);
  if (state == nullptr || !state->aligned) return false;
  return agent.file ? published_.at(agent.id)->arrived() : progress(agent) >= 100;
}

bool DemoWatch::taken_in(const DemoAgent& agent, std::int64_t since) const {
  const auto& [in, out] = streams_.at(agent.id);
  if (!out || out->utime < since) return false;
  if (!in) return true;
  const auto done = done_.find(agent.id);
  if (done != done_.end() && in->utime < done->second) return false;
  return in->content == out->content && in->brick_count == out->brick_count;
}

std::int64_t DemoWatch::revision(const DemoAgent& agent) const {
  const std::optional<BrickDigest>& out = streams_.at(agent.id).out;
  return out ? out->revision : 0;
}

std::int64_t DemoWatch::bytes_sent(const DemoAgent& agent) const {
  return agent.file ? published_.at(agent.id)->bytes_sent() : counter(agent, "bytes_sent");
}

std::int64_t DemoWatch::counter(const DemoAgent& agent, const std::string& name) const {
  const auto status = statuses_.find(std::string(kSim) + agent.id);
  if (status == statuses_.end()) return 0;
  const auto value = status->second.counters.find(name);
  return value != status->second.counters.end() ? value->second : 0;
}

}  // namespace concord
