#include "cli/publish.hpp"

#include <nlohmann/json.hpp>

#include "cli/map_file.hpp"
#include "cli/page.hpp"
#include "core/octomap_writer.hpp"

namespace concord {
namespace {

struct Options {
  std::string file, agent, as = "bricks";
  std::string frame = "file";
};

bool has_all(const AgentList& list, const std::string& agent, const std::string& frame, std::int64_t known) {
  return std::ranges::any_of(list.agents, [&](const AgentState& state) {
    return state.id == agent && state.frame_id == frame && state.synced && state.known == known;
  });
}

Outcome print_sent(const Common& common, const Options& options, std::int64_t known, std::int64_t bytes) {
  common.print({{"agent", options.agent}, {"known", known}, {"bytes_sent", bytes}},
               options.agent + ": " + format_count(known) + " voxels are with the stack, " +
                   format_count((bytes + 999) / 1000) + " kB sent");
  return Exit::kDone;
}

tl::unexpected<Failure> not_arrived(const Options& options) {
  return fail(
      Exit::kIncomplete, "INCOMPLETE",
      "the stack does not report all of " + options.agent + "; see concord status and agents, give a longer --timeout");
}

Outcome publish_bricks(Live& live, const Options& options, const BrickMap& map, const Common& common) {
  PublishedMap published(live, options.agent, options.frame, map);
  live.wait(live.timeout(), [&] { return published.arrived() || published.was_reset(); });
  if (published.was_reset()) return fail(Exit::kRefused, "RESET", options.agent + " was reset meanwhile");
  if (!published.arrived()) return not_arrived(options);
  return print_sent(common, options, published.known(), published.bytes_sent());
}

/// One message; sent again every few seconds, since a large one loses a fragment easily.
Outcome publish_octomap(Live& live, const Options& options, const OctomapImport& loaded, std::int64_t known,
                        const Common& common) {
  constexpr std::int64_t kAgain = 5'000'000;
  auto data = write_octomap_data(loaded.map, OctomapFormat::kFull);
  if (!data) return fail(data.error());
  const Bytes message =
      encode(OctomapMessage{live.bus().now(), options.frame, loaded.resolution, false, std::move(*data)});
  bool arrived = false;
  live.hear<AgentList>("out/agents", [&](const std::string&, const AgentList& list) {
    arrived = has_all(list, options.agent, options.frame, known);
  });
  std::int64_t sent = 0, due = 0;
  live.wait(live.timeout(), [&] {
    if (!arrived && live.bus().now() >= due) {
      live.bus().publish("in/" + options.agent + "/octomap", message);
      sent += static_cast<std::int64_t>(message.size());
      due = live.bus().now() + kAgain;
    }
    return arrived;
  });
  if (!arrived) return not_arrived(options);
  return print_sent(common, options, known, sent);
}

Outcome publish(const Options& options, const Common& common) {
  for (const std::string& name : {options.agent, options.frame}) {
    if (!is_name(name)) return fail(Exit::kUnusable, "BAD_NAME", name + " is no name: 1 to 40 of A-Z a-z 0-9 . _ -");
  }
  Live live(common);
  const auto as_stack = load_map(options.file, live.site().resolution);
  if (!as_stack) return fail(as_stack.error());
  if (as_stack->map.empty()) return fail(Exit::kUnusable, "EMPTY", options.file + " holds no voxel");
  if (options.as == "bricks") return publish_bricks(live, options, as_stack->map, common);
  const auto as_it_is = load_map(options.file);
  if (!as_it_is) return fail(as_it_is.error());
  return publish_octomap(live, options, *as_it_is, static_cast<std::int64_t>(as_stack->map.known_count()), common);
}

}  // namespace

PublishedMap::PublishedMap(Live& live, const std::string& agent, const std::string& frame, const BrickMap& map)
    : known_(static_cast<std::int64_t>(map.known_count())),
      publisher_(live.bus(), live.counters(),
                 {.agent = agent,
                  .resolution = live.site().resolution,
                  .bytes_per_second = live.site().stream.bytes_per_second,
                  .boot_id = live.bus().now()},
                 [this] { was_reset_ = true; }) {
  publisher_.begin_frame(frame);
  publisher_.publish(map);
  live.hear<AgentList>("out/agents", [this, agent, frame](const std::string&, const AgentList& list) {
    arrived_ = has_all(list, agent, frame, known_);
  });
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
