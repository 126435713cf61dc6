// What people ask of merge, ingest and the planner: one request, one answer.

#include <cstdlib>
#include <fstream>
#include <memory>

#include <nlohmann/json.hpp>

#include "cli/arguments.hpp"
#include "cli/live.hpp"
#include "cli/report.hpp"

namespace concord {
namespace {

/// What all requests by a person take.
struct Options {
  std::string name, text, file, author, frame, format, agent;
  std::string op;
  std::vector<double> goal;
  double radius = 0.0;
  bool overwrite = false;
};

std::string author_of(const Options& options) {
  if (!options.author.empty()) return options.author;
  const char* user = std::getenv("USER");
  return user != nullptr && is_name(user) ? user : "cli";
}

Outcome print_answer(const tl::expected<Answer, Failure>& answer, const Common& common) {
  if (!answer) return tl::unexpected(answer.error());
  common.print(to_json(*answer), answer->process + ": " + (answer->message.empty() ? "done" : answer->message));
  return Exit::kDone;
}

tl::unexpected<Failure> bad_name(const std::string& name) {
  return fail(Exit::kUnusable, "BAD_NAME",
              name + " is no name: 1 to 40 of A-Z a-z 0-9 . _ -, beginning with a letter or digit");
}

Outcome set_transform(const Options& options, const Common& common) {
  if (!is_name(options.agent)) return bad_name(options.agent);
  const auto T_map_agent = parse_transform(options.text);
  if (!T_map_agent) return fail(T_map_agent.error());
  Live live(common);
  const TransformRequest request{live.new_id(), author_of(options), options.agent, options.frame, *T_map_agent};
  return print_answer(live.ask("in/transform", encode(request, live.bus().now()), request.id), common);
}

/// One voxel a line: three whole numbers, map lattice.
Result<std::vector<VoxelIndex>> read_voxels(const std::string& file) {
  std::ifstream in(file);
  if (!in) return refuse(Code::kNotFound, "cannot read " + file);
  std::vector<VoxelBox> boxes;
  VoxelIndex v;
  while (in >> v.x >> v.y >> v.z) {
    boxes.push_back({v, v});
    if (static_cast<std::int64_t>(boxes.size()) > kMaxEditVoxels) break;
  }
  if (!in.eof())
    return refuse(Code::kMalformed, file + " must hold one voxel a line: three whole numbers (map lattice)");
  return expand(boxes, kMaxEditVoxels);
}

Result<std::vector<VoxelIndex>> voxels_of(const Options& options, double resolution) {
  if (!options.file.empty()) return read_voxels(options.file);
  return parse_box(options.text, resolution).and_then([](const VoxelBox& box) {
    return expand(std::span(&box, 1), kMaxEditVoxels);
  });
}

Outcome edit(const Options& options, const Common& common) {
  if (options.file.empty() == options.text.empty()) {
    return fail(Exit::kUnusable, "USAGE", "edit needs either --box or --voxels");
  }
  Live live(common);
  auto voxels = voxels_of(options, live.site().resolution);
  if (!voxels) return fail(voxels.error());
  const auto op = options.op == "add" ? EditRequest::Op::kAdd : EditRequest::Op::kDelete;
  const EditRequest request{live.new_id(), author_of(options), op, std::move(*voxels), live.bus().now()};
  return print_answer(live.ask("in/edit", encode(request, live.site().resolution), request.id), common);
}

Outcome ask_map(MapRequest::Op op, const Options& options, const Common& common) {
  for (const std::string& name : {options.name, options.agent}) {
    if (!name.empty() && !is_name(name)) return bad_name(name);
  }
  Live live(common);
  const std::string format = op == MapRequest::Op::kSave && options.format.empty() ? "bt" : options.format;
  const MapRequest request{live.new_id(), op, options.name, format, options.overwrite, options.agent};
  return print_answer(live.ask("in/map_request", encode(request, live.bus().now()), request.id), common);
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
    words += file + "  " + std::to_string((bytes + 999) / 1000) + " kB\n";
  }
  common.print({{"maps", array}}, words.empty() ? "no saved maps" : words);
  return Exit::kDone;
}

Outcome ask_agent(AgentRequest::Op op, const Options& options, const Common& common) {
  if (!is_name(options.agent)) return bad_name(options.agent);
  Live live(common);
  const AgentRequest request{live.new_id(), options.agent, op};
  return print_answer(live.ask("in/agent_request", encode(request, live.bus().now()), request.id), common);
}

Outcome goal(const Options& options, const Common& common) {
  PathRequest request;
  request.robot = options.agent;
  request.goal = {options.goal[0], options.goal[1]};
  request.radius = options.radius;
  request.keep_active = true;
  return ask_path(std::move(request), common);
}

using Command = Outcome (*)(const Options&, const Common&);

CLI::App& add(Program& program, const std::string& name, const std::string& what,
              const std::shared_ptr<Options>& options, Command command) {
  return program.add(name, what, [options, command](const Common& common) { return command(*options, common); });
}

}  // namespace

Outcome ask_path(PathRequest request, const Common& common) {
  if (!is_name(request.robot)) return bad_name(request.robot);
  if (!request.goal.allFinite()) return fail(Exit::kUnusable, "NOT_FINITE", "the goal must be two finite numbers");
  Live live(common);
  request.id = live.new_id();
  const auto path = request_path(live, request);
  if (!path) return tl::unexpected(path.error());
  common.print(to_json(*path), to_words(*path));
  return path->status == "OK" ? Exit::kDone : Exit::kNegative;
}

void add_requests(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& align = add(program, "set-transform", "puts an agent's submap into the map", options, set_transform);
  align.add_option("agent", options->agent, "the agent's id")->required();
  align.add_option("transform", options->text, "T_map_agent as \"x y z qx qy qz qw\"")->required();
  align.add_option("--frame", options->frame, "the agent's frame it was found for; without it the present one");
  align.add_option("--author", options->author, "who asks; without it $USER");

  CLI::App& pin = add(program, "edit", "pins voxels of the map, above every sensor", options, edit);
  pin.add_option("op", options->op, "add or delete")->required()->check(CLI::IsMember({"add", "delete"}));
  pin.add_option("--box", options->text, "\"x0 y0 z0 x1 y1 z1\", metres: every voxel that shares volume with it");
  pin.add_option("--voxels", options->file, "a file with three indices a line, map lattice");
  pin.add_option("--author", options->author, "who edits; without it $USER");

  CLI::App& go = add(program, "goal", "sends a robot's path, and keeps it up to date", options, goal);
  go.add_option("robot", options->agent, "its last pose is the start")->required();
  go.add_option("goal", options->goal, "x y, map frame, metres")->expected(2)->required();
  go.add_option("--radius", options->radius, "of the robot, metres; 0: the site file's")->check(CLI::Range(0.0, 10.0));

  CLI::App& save = add(program, "save", "saves the map", options, [](const Options& o, const Common& common) {
    return ask_map(MapRequest::Op::kSave, o, common);
  });
  save.add_option("name", options->name, "without extension")->required();
  save.add_option("--format", options->format, "bt (the default) or ot")->check(CLI::IsMember({"bt", "ot"}));
  save.add_flag("--overwrite", options->overwrite, "replaces a map of this name");

  CLI::App& load =
      add(program, "load", "makes a saved map one more agent", options,
          [](const Options& o, const Common& common) { return ask_map(MapRequest::Op::kLoad, o, common); });
  load.add_option("name", options->name, "without extension")->required();
  load.add_option("--agent", options->agent, "the agent's id; without it the map's name");

  program.add("maps", "the saved maps", list_maps);

  CLI::App& reset =
      add(program, "reset", "drops what an agent sent; it begins anew", options,
          [](const Options& o, const Common& common) { return ask_agent(AgentRequest::Op::kReset, o, common); });
  reset.add_option("agent", options->agent, "the agent's id")->required();
  CLI::App& remove =
      add(program, "remove", "forgets an agent and what it sent", options,
          [](const Options& o, const Common& common) { return ask_agent(AgentRequest::Op::kRemove, o, common); });
  remove.add_option("agent", options->agent, "the agent's id")->required();
}

}  // namespace concord
