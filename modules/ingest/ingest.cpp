#include "ingest/ingest.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/map_archive.hpp"
#include "core/octomap_reader.hpp"
#include "core/requests.hpp"

namespace concord {
namespace {

constexpr std::int64_t kMaxSequence = std::int64_t{1} << 62;  // so that the next one is a number too
constexpr std::size_t kLongestName = 40;                      // is_name

OctomapLimits limits_of(const Ingest::Config& config) {
  OctomapLimits limits;
  limits.known_voxels = static_cast<std::uint64_t>(config.max_known_voxels);
  return limits;
}

/// The bricks in which two layers differ, ascending.
std::vector<BrickIndex> difference(const BrickMap& before, const BrickMap& after) {
  std::vector<BrickIndex> bricks;
  before.for_each_brick([&](BrickIndex index, const Brick&) {
    if (after.find(index) == nullptr) bricks.push_back(index);
  });
  after.for_each_brick([&](BrickIndex index, const Brick& brick) {
    const Brick* old = before.find(index);
    if (old == nullptr || !(*old == brick)) bricks.push_back(index);
  });
  std::sort(bricks.begin(), bricks.end());
  return bricks;
}

bool is_dead(const Agent& agent, const std::string& frame_id) {
  return std::find(agent.dead_frames.begin(), agent.dead_frames.end(), frame_id) != agent.dead_frames.end();
}

/// Whether this start of the sender was followed by a later one, or by none that still speaks.
bool is_stale(const Agent& agent, std::int64_t boot_id, std::int64_t now) {
  return boot_id < agent.next_cloud.boot_id && now - agent.last_cloud < Ingest::kBootSilence;
}

tl::unexpected<Error> too_many_voxels(const std::string& id) {
  return refuse(Code::kTooLarge, "layer of " + id + " is full; raise ingest.max_known_voxels in the site file");
}

tl::unexpected<Error> unknown_agent(const std::string& id) {
  return refuse(Code::kNoAgent, "no agent is called " + id + "; concord agents lists them");
}

}  // namespace

Result<void> Ingest::admit(const std::string& id, const std::string& frame_id, Source source) const {
  if (!is_name(id)) return refuse(Code::kBadName, "an agent's id is 1 to 40 of A-Z a-z 0-9 . _ -");
  if (!is_name(frame_id)) return refuse(Code::kBadFrame, "frame_id must be 1 to 40 of A-Z a-z 0-9 . _ -");
  const Agent* agent = find(id);
  if (agent == nullptr) {
    if (static_cast<std::int64_t>(agents_.size()) < config_.max_agents) return {};
    return refuse(Code::kTooLarge, "there are " + std::to_string(agents_.size()) +
                                       " agents; remove one or raise ingest.max_agents in the site file");
  }
  if (source == Source::kFile) {
    return refuse(Code::kExists, "there is an agent called " + id + "; load under another id, or remove it first");
  }
  if (is_dead(*agent, frame_id)) {
    return refuse(Code::kBadFrame, "frame " + frame_id + " of " + id + " was reset; start a new frame_id");
  }
  if (agent->frame_id == frame_id && agent->source == Source::kStream && source != Source::kStream) {
    return refuse(Code::kBadRequest, "frame " + frame_id + " of " + id +
                                         " comes as a brick stream; stop that one, or use another frame_id");
  }
  return {};
}

bool Ingest::is_over(const std::string& id, const std::string& frame_id) const {
  const Agent* agent = find(id);
  return agent != nullptr && is_dead(*agent, frame_id);
}

Agent& Ingest::enter(const std::string& id, const std::string& frame_id, Source source, Change& change) {
  Agent& agent = agents_[id];
  if (agent.incarnation == 0) agent.incarnation = ++last_incarnation_;
  if (agent.frame_id != frame_id) {
    agent.frame_id = frame_id;
    agent.next_cloud = {};
    agent.layer.clear();
    change.new_frame = true;
  }
  agent.source = source;
  return agent;
}

Result<Change> Ingest::begin_stream(const std::string& id, const std::string& frame_id) {
  if (auto ok = admit(id, frame_id, Source::kStream); !ok) return tl::unexpected(ok.error());
  Change change;
  Agent& agent = enter(id, frame_id, Source::kStream, change);
  change.bricks = agent.layer.sorted_bricks();
  agent.layer.clear();
  return change;
}

Result<bool> Ingest::set_brick(const std::string& id, BrickIndex index, Brick brick) {
  const auto it = agents_.find(id);
  assert(it != agents_.end() && it->second.source == Source::kStream);
  Agent& agent = it->second;
  const Brick* old = agent.layer.find(index);
  const std::int64_t more = brick.known_count() - (old != nullptr ? old->known_count() : 0);
  if (more > 0 && agent.known() + more > config_.max_known_voxels) return too_many_voxels(id);
  return agent.layer.set(index, std::move(brick));
}

Result<Change> Ingest::take_octomap(const std::string& id, const std::string& frame_id, ByteSpan data,
                                    OctomapFormat format, double resolution) {
  if (auto ok = admit(id, frame_id, Source::kOctomap); !ok) return tl::unexpected(ok.error());
  auto import = read_octomap_data(data, format, resolution, config_.resolution, limits_of(config_));
  if (!import) return tl::unexpected(import.error());
  Change change;
  Agent& agent = enter(id, frame_id, Source::kOctomap, change);
  change.bricks = difference(agent.layer, import->map);
  agent.layer = std::move(import->map);
  return change;
}

Result<CloudChange> Ingest::take_cloud(const std::string& id, const std::string& frame_id, CloudNumber number,
                                       Scan scan, std::int64_t now) {
  if (auto ok = admit(id, frame_id, Source::kClouds); !ok) return tl::unexpected(ok.error());
  const auto [boot_id, sequence] = number;
  if (sequence < 0 || sequence > kMaxSequence) return refuse(Code::kBadRequest, "sequence counts up by one from 0");
  const Agent* before = find(id);
  const bool goes_on = before != nullptr && before->frame_id == frame_id;
  if (goes_on && is_stale(*before, boot_id, now)) {
    return refuse(Code::kStale, "a cloud of an earlier start of " + id);
  }
  const bool same_start = goes_on && before->next_cloud.boot_id == boot_id;
  const std::int64_t expected = same_start ? before->next_cloud.sequence : 0;
  if (sequence < expected) return CloudChange{.change = {}, .duplicate = true};
  if (goes_on && before->known() >= config_.max_known_voxels) return too_many_voxels(id);
  auto fit = checked(std::move(scan), config_.resolution);
  if (!fit) return tl::unexpected(fit.error());

  // A refusal by `integrate` must leave no new frame and no new agent: those are made from an empty layer.
  BrickMap begun;
  BrickMap& layer = goes_on ? agents_.at(id).layer : begun;
  auto bricks = integrate(layer, config_.resolution, fit->scan);
  if (!bricks) return tl::unexpected(bricks.error());
  CloudChange taken{.change = {}, .lost = sequence - expected, .duplicate = false, .skipped = fit->skipped};
  Agent& agent = enter(id, frame_id, Source::kClouds, taken.change);
  if (!goes_on) agent.layer = std::move(begun);
  agent.next_cloud = {boot_id, sequence + 1};
  agent.last_cloud = now;
  taken.change.bricks = std::move(*bricks);
  return taken;
}

Result<Agent> Ingest::after_reset(const std::string& id) const {
  const Agent* agent = find(id);
  if (agent == nullptr) return unknown_agent(id);
  Agent after;
  after.incarnation = agent->incarnation;
  after.frame_id = agent->frame_id;
  after.source = agent->source;
  after.dead_frames = agent->dead_frames;
  if (!is_dead(after, after.frame_id)) after.dead_frames.push_back(after.frame_id);
  if (after.dead_frames.size() > kMaxDeadFrames) after.dead_frames.erase(after.dead_frames.begin());
  return after;
}

Result<Agent> Ingest::from_file(const std::string& id, const std::string& map, ByteSpan file) const {
  // Cut to what a frame may be called; it only has to differ from the agent's other frames.
  const std::string frame_id = ("map-" + map).substr(0, kLongestName);
  if (auto ok = admit(id, frame_id, Source::kFile); !ok) return tl::unexpected(ok.error());
  auto import = read_octomap_file(file, config_.resolution, limits_of(config_));
  if (!import) return tl::unexpected(import.error());
  Agent agent;
  agent.incarnation = last_incarnation_ + 1;
  agent.frame_id = frame_id;
  agent.source = Source::kFile;
  agent.layer = std::move(import->map);
  return agent;
}

Result<std::vector<std::pair<std::string, Agent>>> Ingest::from_archive(ByteSpan file,
                                                                        const std::string& request_id) const {
  MapArchiveOptions options;
  options.resolution = config_.resolution;
  options.known_voxels = static_cast<std::uint64_t>(config_.max_known_voxels);
  auto archive = read_map_archive(file, options);
  if (!archive) return tl::unexpected(archive.error());
  for (const SavedLayer& layer : archive->layers) {
    if (find(layer.head.agent) != nullptr) {
      return refuse(Code::kExists, "there is an agent called " + layer.head.agent + "; remove it first");
    }
    if (auto ok = admit(layer.head.agent, layer.head.frame_id, Source::kFile); !ok) return tl::unexpected(ok.error());
  }
  if (static_cast<std::int64_t>(agents_.size() + archive->layers.size()) > config_.max_agents) {
    return refuse(Code::kTooLarge, "with the " + std::to_string(archive->layers.size()) +
                                       " of the map there would be over " + std::to_string(config_.max_agents) +
                                       " agents; remove some or raise ingest.max_agents in the site file");
  }
  const std::int64_t incarnation = loaded_incarnation(file, request_id);
  std::vector<std::pair<std::string, Agent>> agents;
  for (SavedLayer& layer : archive->layers) {
    Agent agent;
    agent.incarnation = incarnation;
    agent.frame_id = std::move(layer.head.frame_id);
    agent.source = Source::kFile;
    agent.layer = std::move(layer.bricks);
    agents.emplace_back(std::move(layer.head.agent), std::move(agent));
  }
  return agents;
}

Change Ingest::put(const std::string& id, Agent agent) {
  // Others are counted on; those of loaded agents are not counted.
  if (agent.incarnation < kLoadedIncarnation) last_incarnation_ = std::max(last_incarnation_, agent.incarnation);
  Agent& present = agents_[id];
  Change change;
  change.new_frame = present.frame_id != agent.frame_id;
  if (change.new_frame) present.layer.clear();
  change.bricks = difference(present.layer, agent.layer);
  present = std::move(agent);
  return change;
}

const Agent* Ingest::find(const std::string& id) const {
  const auto it = agents_.find(id);
  return it != agents_.end() ? &it->second : nullptr;
}

std::optional<std::int64_t> Ingest::loaded(std::int64_t incarnation) const {
  std::optional<std::int64_t> known;
  for (const auto& [id, agent] : agents_) {
    if (agent.incarnation == incarnation) known = known.value_or(0) + agent.known();
  }
  return known;
}

}  // namespace concord
