#include <memory>

#include <nlohmann/json.hpp>

#include "cli/live.hpp"
#include "cli/map_file.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"

namespace concord {
namespace {

struct Options {
  std::string out, agent;
};

std::string stream_of(const Options& options) {
  return options.agent.empty() ? "out/map" : "out/agent/" + options.agent;
}

/// Takes a stream whole, and a file if one is asked for.
Outcome take(const Options& options, const Common& common, bool only_digest) {
  if (!options.agent.empty() && !is_name(options.agent)) {
    return bad_name(options.agent);
  }
  Live live(common);
  if (const auto taken = live.take_resolution(); !taken) return tl::unexpected(taken.error());
  StreamCopy copy(live, stream_of(options));
  const auto synced = options.agent.empty() ? copy.wait_synced(live) : wait_for_submap(live, copy, options.agent);
  if (!synced) return tl::unexpected(synced.error());
  if (!options.out.empty()) {
    const auto saved = save_map(options.out, copy.map(), live.site().resolution);
    if (!saved) return fail(saved.error());
  }
  const auto known = static_cast<std::int64_t>(copy.map().known_count());
  const auto occupied = static_cast<std::int64_t>(copy.map().occupied_count());
  const std::string hash = hex(digest(copy.map()));
  common.print({{"digest", hash},
                {"known", known},
                {"occupied", occupied},
                {"free", known - occupied},
                {"revision", copy.revision()}},
               only_digest ? hash
                           : format_count(known) + " known voxels, " + format_count(occupied) +
                                 " occupied, written to " + options.out);
  return Exit::kDone;
}

}  // namespace

void add_map(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& map = program.add("map", "takes the live map to a file",
                              [options](const Common& common) { return take(*options, common, false); });
  map.add_option("--out", options->out, "a .bt or .ot file")->required();
  CLI::App& hash = program.add("digest", "the hash of the live map: equal maps on any machine, equal digests",
                               [options](const Common& common) { return take(*options, common, true); });
  for (CLI::App* command : {&map, &hash}) {
    command->add_option("--agent", options->agent, "this agent's submap, in its own frame, instead of the map");
  }
}

}  // namespace concord
