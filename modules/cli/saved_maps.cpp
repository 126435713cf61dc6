#include <memory>

#include <nlohmann/json.hpp>

#include "cli/live.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"

namespace concord {
namespace {

struct Save {
  std::string map, format = "bt";
  bool overwrite = false;
};

struct Load {
  std::string map, agent;
};

Outcome ask(MapRequest request, const Common& common) {
  for (const std::string& name : {request.map, request.agent}) {
    if (!name.empty() && !is_name(name)) return bad_name(name);
  }
  Live live(common);
  request.id = live.new_id();
  const auto answer = live.ask("in/map_request", encode(request, live.bus().now()), request.id);
  if (!answer || request.op != MapRequest::Op::kLoad) return print_answer(answer, common);
  const std::string& agent = request.agent.empty() ? request.map : request.agent;
  nlohmann::json object = to_json(*answer);
  object["agent"] = agent;
  common.print(
      object, answer->process + ": " + answer->message + ": concord set-transform " + agent + " \"x y z qx qy qz qw\"");
  return Exit::kDone;
}

Outcome list_maps(const Common& common) {
  Live live(common);
  const MapRequest request{live.new_id(), MapRequest::Op::kList, "", "", false, ""};
  std::optional<MapList> list;
  live.hear<MapList>("out/map_list", [&](const std::string&, MapList heard) {
    if (heard.id == request.id) list = std::move(heard);
  });
  const auto done = [&] {
    const Answer* answer = live.answer_to(request.id);
    return list.has_value() || (answer != nullptr && !answer->ok);
  };
  if (!live.ask_until("in/map_request", encode(request, live.bus().now()), live.timeout(), done)) {
    return live.no_answer("merge");
  }
  if (!list) return print_answer(live.ask("in/map_request", encode(request, live.bus().now()), request.id), common);
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
  CLI::App& saving = program.add("save", "saves the map", [save](const Common& common) {
    return ask({"", MapRequest::Op::kSave, save->map, save->format, save->overwrite, ""}, common);
  });
  saving.add_option("name", save->map, "without extension")->required();
  saving.add_option("--format", save->format, "bt or ot")->check(CLI::IsMember({"bt", "ot"}))->capture_default_str();
  saving.add_flag("--overwrite", save->overwrite, "replaces a map of this name");

  auto load = std::make_shared<Load>();
  CLI::App& loading = program.add("load", "makes a saved map one more agent", [load](const Common& common) {
    return ask({"", MapRequest::Op::kLoad, load->map, "", false, load->agent}, common);
  });
  loading.add_option("name", load->map, "without extension")->required();
  loading.add_option("--agent", load->agent, "the agent's id; without it the map's name");

  program.add("maps", "the saved maps", list_maps);
}

}  // namespace concord
