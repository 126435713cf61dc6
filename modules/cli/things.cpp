// things: what was seen of known objects, and a person's word on it.

#include <memory>

#include "bus/messages_detection.hpp"
#include "cli/arguments.hpp"
#include "cli/list_copy.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"
#include "cli/semantic_commands.hpp"
#include "cli/table.hpp"

namespace concord {
namespace {

struct Options {
  std::string op = "list", author, id;
  std::int64_t number = 0;
};

nlohmann::json to_json(const Thing& thing) {
  return {{"thing", thing.number},        {"asset", thing.asset},
          {"class", thing.class_name},    {"score", thing.score},
          {"sightings", thing.sightings}, {"last_seen", thing.last_seen},
          {"author", thing.author},       {"T_map_asset", to_numbers(thing.T_map_asset)},
          {"injection", thing.injection}};
}

Outcome list(const Common& common) {
  Live live(common);
  ListCopy<Thing> copy(live, "semantic", "out/things");
  const auto things = copy.wait_synced(live);
  if (!things) return tl::unexpected(things.error());
  nlohmann::json all = nlohmann::json::array();
  std::vector<std::vector<std::string>> rows;
  for (const Thing& thing : *things) {
    all.push_back(to_json(thing));
    const Eigen::Vector3d p = thing.T_map_asset.translation();
    rows.push_back({std::to_string(thing.number), thing.asset, format_number(thing.score, 2),
                    format_count(thing.sightings) + " sightings",
                    format_number(p.x(), 2) + " " + format_number(p.y(), 2) + " " + format_number(p.z(), 2),
                    thing.injection.empty() ? "to be confirmed" : "injected by " + thing.injection});
  }
  common.print({{"things", all}}, rows.empty() ? "nothing was seen" : format_table(rows, "rlrrll"));
  return Exit::kDone;
}

Outcome decide(const Options& options, const Common& common) {
  if (options.number < 1)
    return fail(Exit::kUnusable, "BAD_REQUEST", "name the thing by its number; see: concord things");
  Live live(common);
  const auto op = options.op == "confirm" ? DetectionDecision::Op::kConfirm : DetectionDecision::Op::kDrop;
  const DetectionDecision decision{live.id_or_new(options.id), author_or_user(options.author), op, options.number,
                                   live.bus().now()};
  return print_answer(live.ask("in/detection_decision", decision), common);
}

}  // namespace

void add_things(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add(
      "things", "what was seen of known objects; confirmed, they are put into the map",
      [options](const Common& common) { return options->op == "list" ? list(common) : decide(*options, common); });
  command.add_option("op", options->op, "list; confirm: it is injected, fitted to the map; drop: it is none")
      ->check(CLI::IsMember({"list", "confirm", "drop"}));
  command.add_option("number", options->number, "of the thing");
  command.add_option("--author", options->author, "who says so; without it $USER");
  command.add_option("--id", options->id, "of this request, and of the injection");
}

}  // namespace concord
