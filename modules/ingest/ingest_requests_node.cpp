// The part of IngestNode that does what people ask: resetting, removing and loading agents, coarse views.

#include <algorithm>
#include <cmath>

#include <spdlog/spdlog.h>

#include "core/decimal.hpp"
#include "core/downsample.hpp"
#include "core/map_archive.hpp"
#include "core/octomap_reader.hpp"
#include "ingest/ingest_node.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

/// A part of an answer fits one frame on the wire: 90 points are 1080 bytes.
constexpr std::size_t kPointsInPart = 90;
constexpr double kMaxCell = 10.0;  // metres
constexpr std::size_t kMostAwaiting = 64;
const std::string kMerge = "merge";

tl::unexpected<Error> unknown_agent(const std::string& id) {
  return refuse(Code::kNoAgent, "no agent is called " + id + "; concord agents lists them");
}

/// A saved map on disk.
struct MapFile {
  std::filesystem::path path;
  bool is_archive = false;
};

/// Without a format: the one that says most of those that exist.
Result<MapFile> find_map(const std::filesystem::path& folder, const MapRequest& request) {
  for (const std::string format : {"concord", "ot", "bt"}) {
    if (!request.formats.empty() && !request.names(format)) continue;
    MapFile file{folder / (request.map + "." + format), format == "concord"};
    std::error_code error;
    if (std::filesystem::exists(file.path, error)) return file;
  }
  return refuse(Code::kNoMap, "no saved map is called " + request.map + "; concord maps lists them");
}

const std::string& loaded_as(const MapRequest& request) { return request.agent.empty() ? request.map : request.agent; }

}  // namespace

Answer IngestNode::answer_to(const std::string& id, const Result<std::int64_t>& count, const std::string& done) {
  if (count) return {id, process_, true, "OK", done, 0, *count};
  counters_.refused("request", count.error());
  return {id, process_, false, name(count.error().code), count.error().message, 0, 0};
}

void IngestNode::on_agent_request(const std::string&, const AgentRequest& request) {
  const std::uint64_t content = content_of(request);
  if (answers_.repeat(request.id, process_, content)) return;
  const bool is_reset = request.op == AgentRequest::Op::kReset;
  const auto count = is_reset ? reset(request.agent) : remove(request.agent);
  answers_.give(answer_to(request.id, count, is_reset ? "reset; waits for a new frame_id" : "removed"), content);
}

void IngestNode::on_map_request(const std::string&, const MapRequest& request) {
  if (request.op != MapRequest::Op::kLoad) return;
  const std::uint64_t content = content_of(request);
  if (answers_.repeat(request.id, process_, content)) return;
  const auto file = find_map(site_.state / "maps", request);
  if (!file) return answers_.give(answer_to(request.id, tl::unexpected(file.error()), ""), content);
  if (file->is_archive) return await_merge(request);
  answers_.give(answer_to(request.id, load_octomap(request, file->path),
                          "loaded; agent " + loaded_as(request) + " waits to be aligned"),
                content);
}

/// A native map is loaded when merge has said that nothing speaks against it: then neither has half of it.
void IngestNode::await_merge(const MapRequest& request) {
  if (!request.agent.empty()) {
    const auto refusal =
        refuse(Code::kBadRequest, "a .concord file names its agents; leave agent empty, or load format ot or bt");
    return answer(bus_, answer_to(request.id, refusal, ""));
  }
  std::erase_if(awaiting_, [&](const MapRequest& other) { return other.id == request.id; });
  awaiting_.push_back(request);
  if (awaiting_.size() > kMostAwaiting) awaiting_.pop_front();
  answer(bus_, {request.id, process_, false, name(Code::kBusy), "waits for merge to check the map", 0, 0});
}

/// Of merge, to a request that waits for it: see map_archive.md.
void IngestNode::on_answer(const std::string&, const Answer& word) {
  if (word.process != kMerge) return;
  const auto it = std::ranges::find(awaiting_, word.id, &MapRequest::id);
  if (it == awaiting_.end()) return;
  const bool is_busy = !word.ok && word.code == name(Code::kBusy);
  const bool may_load = is_busy && word.revision >= kLoadedIncarnation;
  if (is_busy && !may_load) return;
  const MapRequest request = *it;
  awaiting_.erase(it);
  if (word.ok) {
    answers_.give(answer_to(request.id, 0, "merge has it whole: nothing is left to load"), content_of(request));
  } else if (may_load) {
    answers_.give(
        answer_to(request.id, load_archive(request, word.revision), "loaded; its agents lie where the map says"),
        content_of(request));
  }
}

/// Done again when it is asked again: parts may have been lost. Not while they are on their way.
void IngestNode::on_downsample(const std::string&, const DownsampleRequest& request) {
  if (replies_.waits(request.id)) return;
  const auto count = downsample(request);
  const Answer reply = answer_to(request.id, count, "all parts were sent");
  if (!count) return answer(bus_, reply);
  replies_.push(request.id, kAnswers, encode(reply, bus_.now()));
}

Result<std::int64_t> IngestNode::reset(const std::string& id) {
  auto after = ingest_.after_reset(id);
  if (!after) return tl::unexpected(after.error());
  if (auto done = store_.replace(id, &*after); !done) return tl::unexpected(done.error());
  const auto input = inputs_.find(id);
  if (input != inputs_.end()) {
    input->second.receiver->close_frame();
    input->second.lacking = false;
  }
  const Agent& agent = *ingest_.find(id);
  const std::int64_t dropped = agent.known();
  const Change change = ingest_.put(id, std::move(*after));
  streams_.tell(id, agent, change);
  say_frame_over(id, agent.frame_id);
  spdlog::info("{}: reset", id);
  return dropped;
}

Result<std::int64_t> IngestNode::remove(const std::string& id) {
  const Agent* agent = ingest_.find(id);
  if (agent == nullptr) return unknown_agent(id);
  const std::int64_t dropped = agent->known();
  if (auto done = store_.replace(id, nullptr); !done) return tl::unexpected(done.error());
  inputs_.erase(id);
  said_over_.erase(id);
  streams_.end(id);
  ingest_.remove(id);
  counters_.set("known." + id, 0);
  spdlog::info("{}: removed", id);
  return dropped;
}

/// Nothing changes before it is on disk; so neither does anything after a refusal.
Result<std::int64_t> IngestNode::load_octomap(const MapRequest& request, const std::filesystem::path& file) {
  const std::string& id = loaded_as(request);
  if (auto ok = admit(id, request.map, Source::kFile); !ok) return tl::unexpected(ok.error());
  const auto bytes = read_whole_file(file, OctomapLimits{}.bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  auto agent = ingest_.from_file(id, request.map, *bytes);
  if (!agent) return tl::unexpected(agent.error());
  if (auto done = store_.replace(id, &*agent); !done) return tl::unexpected(done.error());
  const Change change = ingest_.put(id, std::move(*agent));
  streams_.tell(id, *ingest_.find(id), change);
  spdlog::info("{}: loaded from map {}", id, request.map);
  return ingest_.find(id)->known();
}

/// All of its layers or none. A request whose answer was lost with the process that gave it is known by what it loaded.
Result<std::int64_t> IngestNode::load_archive(const MapRequest& request, std::int64_t incarnation) {
  if (const auto known = ingest_.loaded(incarnation)) return *known;
  const auto bytes = read_whole_file(site_.state / "maps" / (request.map + ".concord"), kMaxArchiveBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  if (loaded_incarnation(*bytes, request.id) != incarnation) {
    return refuse(Code::kBusy, "the file has changed since merge checked it; ask again");
  }
  auto agents = ingest_.from_archive(*bytes, request.id);
  if (!agents) return tl::unexpected(agents.error());
  if (auto done = store_.add(*agents); !done) return tl::unexpected(done.error());
  for (auto& [id, agent] : *agents) {
    const Change change = ingest_.put(id, std::move(agent));
    streams_.tell(id, *ingest_.find(id), change);
    spdlog::info("{}: loaded from map {}", id, request.map);
  }
  return ingest_.loaded(incarnation).value_or(0);
}

Result<std::int64_t> IngestNode::downsample(const DownsampleRequest& request) {
  const Agent* agent = ingest_.find(request.agent);
  if (agent == nullptr) return unknown_agent(request.agent);
  if (!(request.resolution >= site_.resolution && request.resolution <= kMaxCell)) {
    return refuse(Code::kBadResolution, "resolution must lie between the site's " + decimal(site_.resolution) +
                                            " m and " + decimal(kMaxCell) + " m");
  }
  const std::vector<Eigen::Vector3f> points = concord::downsample(agent->layer, site_.resolution, request.resolution);
  const std::size_t parts = std::max<std::size_t>(1, (points.size() + kPointsInPart - 1) / kPointsInPart);
  if (!replies_.has_room(parts + 1)) {
    return refuse(Code::kTooLarge, "too many points; ask for a coarser resolution, or later");
  }
  for (std::size_t part = 0; part < parts; ++part) {
    const auto first = points.begin() + static_cast<std::ptrdiff_t>(part * kPointsInPart);
    const auto last = points.begin() + static_cast<std::ptrdiff_t>(std::min((part + 1) * kPointsInPart, points.size()));
    const Downsampled value{request.id,
                            request.agent,
                            agent->frame_id,
                            request.resolution,
                            static_cast<std::int32_t>(part),
                            static_cast<std::int32_t>(parts),
                            {first, last}};
    replies_.push(request.id, "out/downsampled", encode(value, bus_.now()));
  }
  return static_cast<std::int64_t>(points.size());
}

}  // namespace concord
