#include "cli/stack_watch.hpp"

#include <bit>

#include <xxhash.h>

namespace concord {
namespace {

/// What the digests are of. Not align: what people accepted of it is in the log as `in/transform`.
constexpr const char* kReplayed[] = {"ingest", "merge", "planner"};

constexpr std::int64_t kStatusAge = 2'500'000;  ///< a process that is busy for longer is at work

std::uint64_t hash(const Bytes& bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

void append(Bytes& out, const std::string& text) {
  append_varint(out, text.size());
  out.insert(out.end(), text.begin(), text.end());
}

std::uint64_t hash(const std::map<std::string, Path>& paths) {
  Bytes out;
  for (const auto& [id, path] : paths) {
    append(out, id);
    append(out, path.robot);
    append(out, path.status);
    append_varint(out, path.points.size());
    for (const Eigen::Vector3d& p : path.points) {
      for (int i = 0; i < 3; ++i) append_le(out, std::bit_cast<std::int64_t>(p[i]));
    }
  }
  return hash(out);
}

std::uint64_t hash(const std::map<std::string, Answer>& answers) {
  Bytes out;
  for (const auto& [id, answer] : answers) {
    append(out, id);
    append(out, answer.code);
  }
  return hash(out);
}

}  // namespace

StackWatch::Copy::Copy(StackWatch& watch, const std::string& stream, double resolution)
    : receiver(watch.bus_, watch.counters_, {.stream = stream, .resolution = resolution},
               {.on_frame = [this](const std::string&) { map.clear(); },
                .on_brick = [this](BrickIndex index, Brick brick) { map.set(index, std::move(brick)); },
                .on_end = [this] { map.clear(); }}) {
  const StreamChannels channels(stream);
  watch.hear<BrickPacket>(channels.bricks, [this](const BrickPacket& packet) { receiver.on_packet(packet); });
  watch.hear<BrickDigest>(channels.digest, [this](const BrickDigest& digest) { receiver.on_digest(digest); });
}

StackWatch::StackWatch(Bus& bus, double resolution)
    : bus_(bus),
      map_(*this, "out/map", resolution),
      conflicts_(*this, "out/conflicts", resolution),
      grid_(*this, "out/grid", resolution) {
  hear<Path>("out/path/[^/]+", [this](const Path& path) { paths_[path.id] = path; });
  hear<Answer>(kAnswers, [this](const Answer& answer) {
    ++messages_;
    answers_[answer.id + " " + answer.process] = answer;
  });
  hear<AgentList>("out/agents", [this](const AgentList& agents) { agents_ = agents; });
  hear<ProcessStatus>("out/status/[^/]+", [this](const ProcessStatus& status) { statuses_[status.process] = status; });
  bus_.every(kLook, [this] { look(); });
}

template <class T, class Take>
void StackWatch::hear(const std::string& channel_regex, Take take) {
  bus_.subscribe(channel_regex, [take](const std::string&, std::span<const std::uint8_t> bytes) {
    if (const auto value = decode<T>(bytes)) take(*value);
  });
}

bool StackWatch::awake() const {
  const auto runs = [this](const char* process) { return statuses_.contains(process); };
  return std::ranges::all_of(kReplayed, runs) && synced();
}

bool StackWatch::synced() const {
  if (!map_.receiver.synced() || !conflicts_.receiver.synced() || !grid_.receiver.synced()) return false;
  if (agents_.utime == 0) return false;
  for (const AgentState& agent : agents_.agents) {
    const bool speaks = agent.revision > 0 || agent.known > 0;  // others only say where they are
    if (speaks && !agent.synced) return false;
  }
  return true;
}

StackWatch::State StackWatch::state() const {
  State state = {map_.receiver.revision(), conflicts_.receiver.revision(), grid_.receiver.revision(), messages_,
                 static_cast<std::int64_t>(hash(paths_))};  // kept paths are said again and again
  for (const AgentState& agent : agents_.agents) {
    state.insert(state.end(), {agent.revision, agent.known, agent.occupied, agent.aligned ? 1 : 0});
  }
  const auto ingest = statuses_.find("ingest");
  if (ingest != statuses_.end()) {
    const auto bytes = ingest->second.counters.find("bytes_in");
    state.push_back(bytes != ingest->second.counters.end() ? bytes->second : 0);
  }
  return state;
}

void StackWatch::look() {
  bool at_rest = awake();
  for (const auto& [process, status] : statuses_) at_rest = at_rest && bus_.now() - status.utime < kStatusAge;
  State now = state();
  at_rest = at_rest && now == before_;
  before_ = std::move(now);
  if (!at_rest) {
    quiet_since_ = 0;
  } else if (quiet_since_ == 0) {
    quiet_since_ = bus_.now();
  }
}

std::map<std::string, std::uint64_t> StackWatch::digests() const {
  return {{"map", digest(map_.map)},
          {"conflicts", digest(conflicts_.map)},
          {"grid", digest(grid_.map)},
          {"paths", hash(paths_)},
          {"answers", hash(answers_)}};
}

}  // namespace concord
