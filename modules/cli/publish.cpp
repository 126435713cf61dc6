#include "cli/publish.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include <nlohmann/json.hpp>

#include "cli/map_file.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"
#include "core/octomap_writer.hpp"

namespace concord {
namespace {

/// A refusal may be of what another sender of this id says; one that goes on while nothing comes in is of ours.
constexpr std::int64_t kRefusals = 2;

struct Options {
  std::string file, agent, as = "bricks";
  std::string frame = "file";
};

Outcome print_sent(const Common& common, const Options& options, const Delivery& delivery, std::int64_t known,
                   std::int64_t bytes) {
  if (delivery.disk_fails()) {
    return fail(Exit::kIncomplete, name(Code::kIo),
                options.agent + ": " + format_count(known) +
                    " voxels are with the stack in memory only: ingest cannot write, and says why; is its disk full?");
  }
  common.print({{"agent", options.agent}, {"known", known}, {"bytes_sent", bytes}},
               options.agent + ": " + format_count(known) + " voxels are with the stack (on its disk within 5 s), " +
                   format_kilobytes(bytes) + " sent");
  return Exit::kDone;
}

bool is_refused(const Delivery& delivery) { return delivery.refusals() >= kRefusals; }

tl::unexpected<Failure> frame_is_over(const Options& options) {
  return fail(Exit::kRefused, name(Code::kBadFrame),
              "frame " + options.frame + " of " + options.agent +
                  " was reset and is over; begin another with --frame NAME, and place it with concord set-transform");
}

tl::unexpected<Failure> not_arrived(const Options& options, const Delivery& delivery) {
  if (delivery.refusal() == name(Code::kBadFrame)) return frame_is_over(options);
  if (delivery.refusal() == name(Code::kStale)) {
    return fail(
        Exit::kRefused, name(Code::kStale),
        "another sender speaks as " + options.agent + " and started later; end it, or publish as another --agent");
  }
  if (!delivery.refusal().empty()) {
    return fail(Exit::kRefused, delivery.refusal(),
                "ingest refuses what " + options.agent + " sends, and has printed why");
  }
  return fail(Exit::kIncomplete, "INCOMPLETE",
              "nothing more of " + options.agent + " arrives at the stack; see concord status and concord agents");
}

Outcome publish_bricks(Live& live, const Options& options, const BrickMap& map, const Common& common) {
  PublishedMap published(live, options.agent, options.frame, map);
  const auto over = [&] { return published.arrived() || published.was_reset() || is_refused(published.delivery()); };
  live.wait_while_moving(
      live.timeout(), [&] { return published.moves(); }, over);
  if (published.was_reset()) return frame_is_over(options);
  if (!published.arrived()) return not_arrived(options, published.delivery());
  return print_sent(common, options, published.delivery(), published.known(), published.bytes_sent());
}

/// One message; sent again every few seconds, since a large one loses a fragment easily.
Outcome publish_octomap(Live& live, const Options& options, const OctomapImport& loaded, const Common& common) {
  constexpr std::int64_t kAgain = 3'000'000;
  auto data = write_octomap_data(loaded.map, OctomapFormat::kFull);
  if (!data) return fail(data.error());
  // What ingest will make of it.
  const auto made = read_octomap_data(*data, OctomapFormat::kFull, loaded.resolution, live.site().resolution);
  if (!made) return fail(made.error());
  const Bytes message =
      encode(OctomapMessage{live.bus().now(), options.frame, loaded.resolution, false, std::move(*data)});
  const Delivery delivery(live, options.agent, options.frame, made->map);
  std::int64_t sent = 0, due = 0;
  const auto over = [&] {
    if (sent > 0 && (delivery.arrived() || is_refused(delivery))) return true;
    if (live.bus().now() >= due) {
      live.bus().publish("in/" + options.agent + "/octomap", message);
      sent += static_cast<std::int64_t>(message.size());
      due = live.bus().now() + kAgain;
    }
    return false;
  };
  live.wait_while_moving(
      live.timeout(), [&] { return delivery.moves(); }, over);
  if (!delivery.arrived()) return not_arrived(options, delivery);
  return print_sent(common, options, delivery, static_cast<std::int64_t>(made->map.known_count()), sent);
}

Outcome publish(const Options& options, const Common& common) {
  for (const std::string& name : {options.agent, options.frame}) {
    if (!is_name(name)) return bad_name(name);
  }
  Live live(common);
  if (const auto taken = live.take_resolution(); !taken) return tl::unexpected(taken.error());
  const bool as_bricks = options.as == "bricks";
  const auto loaded = load_map(options.file, as_bricks ? std::optional(live.site().resolution) : std::nullopt);
  if (!loaded) return fail(loaded.error());
  if (loaded->map.empty()) return fail(Exit::kUnusable, "EMPTY", options.file + " holds no voxel");
  return as_bricks ? publish_bricks(live, options, loaded->map, common)
                   : publish_octomap(live, options, *loaded, common);
}

}  // namespace

Delivery::Delivery(Live& live, const std::string& agent, const std::string& frame, const BrickMap& map)
    : agent_(agent), frame_(frame), brick_count_(static_cast<std::int64_t>(map.brick_count())), content_(digest(map)) {
  live.hear<BrickDigest>(StreamChannels("out/agent/" + agent).digest,
                         [this](const std::string&, const BrickDigest& digest) { on_digest(digest); });
  live.hear<AgentList>("out/agents", [this](const std::string&, const AgentList& list) { on_agents(list); });
  live.hear<ProcessStatus>("out/status/ingest",
                           [this](const std::string&, const ProcessStatus& status) { on_status(status); });
}

void Delivery::on_digest(const BrickDigest& digest) {
  held_ = digest.frame_id == frame_ && digest.brick_count == brick_count_ && digest.content == content_;
  if (digest.revision != revision_ || digest.content != last_content_) {
    moved();
    taken_ = false;  // until merge speaks of this revision
  }
  revision_ = digest.revision;
  last_content_ = digest.content;
}

void Delivery::on_agents(const AgentList& list) {
  const auto state = std::ranges::find(list.agents, agent_, &AgentState::id);
  if (state == list.agents.end()) return;
  if (state->known != known_) moved();
  known_ = state->known;
  taken_ = state->frame_id == frame_ && state->synced && state->revision == revision_;
}

void Delivery::on_status(const ProcessStatus& status) {
  const std::string ours = "refused.in/" + agent_;
  for (const auto& [counter, count] : status.counters) {
    if (counter == "disk_fails") disk_fails_ = count != 0;
    const std::size_t dot = counter.rfind('.');
    const std::string where = counter.substr(0, dot);
    if (where != ours && !where.starts_with(ours + "/")) continue;
    const std::int64_t before = std::exchange(refused_[counter], count);
    if (!status_heard_ || before == count) continue;
    ++refusals_;
    refusal_ = counter.substr(dot + 1);
  }
  status_heard_ = true;
}

void Delivery::moved() {
  ++moves_;
  refusals_ = 0;
  refusal_.clear();
}

PublishedMap::PublishedMap(Live& live, const std::string& agent, const std::string& frame, const BrickMap& map)
    : known_(static_cast<std::int64_t>(map.known_count())),
      delivery_(live, agent, frame, map),
      publisher_(live.bus(), live.counters(),
                 {.agent = agent,
                  .resolution = live.site().resolution,
                  .bytes_per_second = live.site().stream.bytes_per_second,
                  .boot_id = live.bus().now()},
                 [this] { was_reset_ = true; }) {
  publisher_.begin_frame(frame);
  publisher_.publish(map);
}

void add_publish(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add("publish", "sends a map file as a robot would, until the stack has it all",
                                  [options](const Common& common) { return publish(*options, common); });
  command.add_option("file", options->file, ".bt or .ot")->required();
  command.add_option("--agent", options->agent, "the id it sends as")->required();
  command.add_option("--frame", options->frame, "the agent's frame: another one begins its submap anew")
      ->capture_default_str();
  command.add_option("--as", options->as, "bricks: as a Concord robot; octomap: one whole octomap_t")
      ->check(CLI::IsMember({"bricks", "octomap"}))
      ->capture_default_str();
}

}  // namespace concord
