#include <array>
#include <memory>

#include <nlohmann/json.hpp>

#include "cli/live.hpp"
#include "cli/load_archive.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"

namespace concord {
namespace {

struct Save {
  std::string map;
  std::vector<std::string> formats{"bt"};
  bool overwrite = false;
};

struct Load {
  std::string map, format, agent, id;
};

Outcome save_map(const Save& save, const Common& common) {
  if (!is_name(save.map)) return bad_name(save.map);
  Live live(common);
  const MapRequest request{live.new_id(), MapRequest::Op::kSave, save.map, save.formats, save.overwrite, ""};
  const auto answer = live.ask("in/map_request", request);
  if (!answer) return tl::unexpected(answer.error());
  nlohmann::json object = to_json(*answer);
  object["digest"] = hex(answer->content);
  object["bytes"] = answer->parts;
  common.print(object, answer->process + ": " + answer->message);
  return Exit::kDone;
}

tl::expected<MapList, Failure> request_list(Live& live) {
  const MapRequest request{live.new_id(), MapRequest::Op::kList, "", {}, false, ""};
  const auto list = std::make_shared<std::optional<MapList>>();  // the subscription outlives this call
  live.hear<MapList>("out/map_list", [list, id = request.id](const std::string&, MapList heard) {
    if (heard.id == id) *list = std::move(heard);
  });
  const auto done = [&] {
    const Answer* answer = live.answer_to(request.id);
    return list->has_value() || (answer != nullptr && !answer->ok);
  };
  const auto bytes = to_send(request, live.bus().now());
  if (!bytes) return tl::unexpected(bytes.error());
  if (!live.ask_until("in/map_request", *bytes, live.timeout(), done)) {
    return live.no_answer("merge");
  }
  if (!*list) return refused(*live.answer_to(request.id));
  return **list;
}

/// The format that says the most of those there are; empty: there is no such map, which ingest says better.
std::string best_format(const MapList& list, const std::string& map) {
  for (const char* format : {"concord", "ot", "bt"}) {
    for (const auto& [file, bytes] : list.files) {
      if (file == map + "." + format) return format;
    }
  }
  return "";
}

Outcome load(const Load& load, const Common& common) {
  if (const auto fine = check_own_id(load.id); !fine) return fail(fine.error());
  if (!load.agent.empty() && !is_name(load.agent)) return bad_name(load.agent);
  if (!is_name(load.map)) return bad_name(load.map);
  Live live(common);
  std::string format = load.format;
  if (format.empty()) {
    const auto list = request_list(live);
    if (!list) return tl::unexpected(list.error());
    format = best_format(*list, load.map);
  }
  MapRequest request{live.id_or_new(load.id), MapRequest::Op::kLoad, load.map, {}, false, load.agent};
  if (!format.empty()) request.formats = {format};
  if (format == "concord") return load_archive(live, request, common);
  const auto answer = live.ask("in/map_request", request);
  if (!answer) return tl::unexpected(answer.error());
  const std::string& agent = request.agent.empty() ? request.map : request.agent;
  nlohmann::json object = to_json(*answer);
  object["agent"] = agent;
  common.print(
      object, answer->process + ": " + answer->message + ": concord set-transform " + agent + " \"x y z qx qy qz qw\"");
  return Exit::kDone;
}

Outcome list_maps(const Common& common) {
  Live live(common);
  const auto list = request_list(live);
  if (!list) return tl::unexpected(list.error());
  nlohmann::json array = nlohmann::json::array();
  std::string words;
  for (const auto& [file, bytes] : list->files) {
    array.push_back({{"file", file}, {"bytes", bytes}});
    words += file + "  " + format_kilobytes(bytes) + "\n";
  }
  common.print({{"maps", array}}, words.empty() ? "no saved maps" : words);
  return Exit::kDone;
}

}  // namespace

void add_saved_maps(Program& program) {
  auto save = std::make_shared<Save>();
  CLI::App& saving =
      program.add("save", "saves the map", [save](const Common& common) { return save_map(*save, common); });
  saving.add_option("name", save->map, "without extension")->required();
  saving
      .add_option(
          "--format", save->formats,
          "bt or ot: the merged map for other programs; concord: every layer, and all that people made; several "
          "with commas: all are written or none")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"bt", "ot", "concord"}))
      ->capture_default_str();
  saving.add_flag("--overwrite", save->overwrite, "replaces a map of this name");

  auto load_options = std::make_shared<Load>();
  CLI::App& loading = program.add("load", "brings a saved map back: .bt and .ot as one more agent, .concord as it was",
                                  [load_options](const Common& common) { return load(*load_options, common); });
  loading.add_option("name", load_options->map, "without extension")->required();
  loading.add_option("--format", load_options->format, "without it the one that says the most: concord, ot, bt")
      ->check(CLI::IsMember({"bt", "ot", "concord"}));
  loading.add_option("--agent", load_options->agent, "of .bt and .ot: the agent's id; without it the map's name");
  loading.add_option("--id", load_options->id, "of this request: what did not end in time can be asked again with it");

  program.add("maps", "the saved maps", list_maps);
}

}  // namespace concord
