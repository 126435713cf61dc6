// detect: known models in an agent's occupied surface, or in a map file.

#include <algorithm>
#include <filesystem>
#include <memory>

#include "bus/messages_detection.hpp"
#include "cli/arguments.hpp"
#include "cli/map_file.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"
#include "cli/semantic_commands.hpp"
#include "cli/table.hpp"
#include "semantic/assets/asset_folder.hpp"
#include "semantic/detections/find_model.hpp"
#include "semantic/models/model_file.hpp"

namespace concord {
namespace {

struct Options {
  std::string map, model, agent, up;
  std::vector<std::string> assets;
  double scale = 1.0, min_score = 0.75;
};

/// A glTF is y up, by its standard; all others are taken to be z up.
Eigen::Vector3d up_of(const Options& options, const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension();
  const bool is_gltf = extension == ".glb" || extension == ".gltf";
  if (options.up.empty() ? is_gltf : options.up == "y") return Eigen::Vector3d::UnitY();
  return options.up == "x" ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
}

nlohmann::json to_json(const std::string& name, const FoundModel& found) {
  return {{"model", name},
          {"T_map_model", to_numbers(found.T_map_model)},
          {"score", found.score},
          {"matched", found.matched},
          {"free", found.free}};
}

std::vector<std::string> to_row(const std::string& name, const FoundModel& found) {
  const Eigen::Vector3d p = found.T_map_model.translation();
  return {name, format_number(p.x(), 2) + " " + format_number(p.y(), 2) + " " + format_number(p.z(), 2),
          "score " + format_number(found.score, 2), format_number(100 * found.matched, 0) + " % of it is there"};
}

Outcome print(const nlohmann::json& all, const std::vector<std::vector<std::string>>& rows, const Common& common) {
  common.print({{"found", all}}, rows.empty() ? "found none" : format_table(rows, "llrr"));
  return rows.empty() ? Exit::kNegative : Exit::kDone;
}

Outcome in_file(const Options& options, const Common& common) {
  const auto map = load_map(options.map);
  if (!map) return fail(map.error());
  const auto mesh = read_model_file(options.model);
  if (!mesh) return fail(mesh.error());
  const auto found = find_model(*mesh, options.scale, map->map, map->resolution,
                                {up_of(options, options.model), options.min_score, 20});
  if (!found) return fail(found.error());
  nlohmann::json all = nlohmann::json::array();
  std::vector<std::vector<std::string>> rows;
  const std::string name = std::filesystem::path(options.model).filename();
  for (const FoundModel& one : *found) {
    all.push_back(to_json(name, one));
    rows.push_back(to_row(name, one));
  }
  return print(all, rows, common);
}

Detection detection_of(Live& live, const Options& options, const std::string& asset, const FoundModel& found) {
  Detection detection;
  detection.id = live.new_id();
  detection.author = "detector";
  detection.asset = asset;
  detection.score = std::clamp(found.score, 0.0, 1.0);
  detection.T_frame_asset = found.T_map_model;
  detection.frame.agent = options.agent;
  detection.utime = live.bus().now();
  return detection;
}

/// The assets that are meant; all, if none is named.
tl::expected<std::vector<Asset>, Failure> assets_to_find(const Options& options, const std::filesystem::path& folder) {
  const auto read = read_asset_folder(folder);
  if (!read) return fail(read.error());
  std::vector<Asset> out;
  for (const std::string& name : options.assets) {
    const auto it = read->assets.find(name);
    if (it == read->assets.end()) return fail({Code::kNotFound, "no asset " + name + "; see: concord asset list"});
    out.push_back(it->second);
  }
  if (!options.assets.empty()) return out;
  for (const auto& [name, asset] : read->assets) out.push_back(asset);
  return out;
}

/// What is found of one asset, and said as anybody who sees something does.
struct Told {
  nlohmann::json all = nlohmann::json::array(), failed = nlohmann::json::array();
  std::vector<std::vector<std::string>> rows;
  std::string failures;
};

tl::expected<void, Failure> tell(Live& live, const Options& options, const std::string& name,
                                 const std::vector<FoundModel>& found, Told& told) {
  for (const FoundModel& one : found) {
    const auto answer = live.ask("in/detection", detection_of(live, options, name, one));
    if (!answer) return tl::unexpected(answer.error());
    auto object = to_json(name, one);
    object["thing"] = answer->revision;
    told.all.push_back(object);
    told.rows.push_back(to_row(name, one));
    told.rows.back().push_back(answer->message);
  }
  return {};
}

/// An asset whose model cannot be used does not keep the others from being found.
Outcome in_agent(const Options& options, const Common& common) {
  if (!options.agent.empty() && !is_name(options.agent)) return bad_name(options.agent);
  Live live(common);
  if (const auto taken = live.take_resolution(); !taken) return tl::unexpected(taken.error());
  const auto folder = live.site().state / "assets";
  const auto assets = assets_to_find(options, folder);
  if (!assets) return tl::unexpected(assets.error());
  StreamCopy copy(live, options.agent.empty() ? "out/map" : "out/agent/" + options.agent);
  const auto synced = options.agent.empty() ? copy.wait_synced(live) : wait_for_submap(live, copy, options.agent);
  if (!synced) return tl::unexpected(synced.error());
  Told told;
  for (const Asset& asset : *assets) {
    const auto found = read_model_file(folder / asset.file).and_then([&](const TriangleMesh& mesh) {
      return find_model(mesh, asset.unit, copy.map(), live.site().resolution,
                        {up_of(options, asset.file), options.min_score, 20});
    });
    if (!found) {
      told.failed.push_back(
          {{"asset", asset.name}, {"code", name(found.error().code)}, {"message", found.error().message}});
      told.failures += "\n" + asset.name + " was not looked for: " + found.error().message;
      continue;
    }
    if (const auto done = tell(live, options, asset.name, *found, told); !done) return tl::unexpected(done.error());
  }
  common.print({{"found", told.all}, {"failed", told.failed}},
               (told.rows.empty() ? "found none" : format_table(told.rows, "llrrl")) + told.failures);
  if (!told.failed.empty() && told.rows.empty()) return Exit::kRefused;
  return told.rows.empty() ? Exit::kNegative : Exit::kDone;
}

}  // namespace

void add_detect(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command =
      program.add("detect", "finds known models: those of the server in the map, or one in a map file",
                  [options](const Common& common) -> Outcome {
                    if (options->map.empty() != options->model.empty()) {
                      return fail(Exit::kUnusable, "BAD_REQUEST",
                                  "a map file goes with --model, and neither with the running stack");
                    }
                    return options->map.empty() ? in_agent(*options, common) : in_file(*options, common);
                  });
  command.add_option("map", options->map, ".bt or .ot; without it the running stack's, and what is found is told it");
  command.add_option("--model", options->model, ".glb, .gltf, .obj, .stl or .ply; with a map file");
  command.add_option("--scale", options->scale, "metres per unit of the model")->check(CLI::Range(1e-9, 1e9));
  command.add_option("--agent", options->agent, "whose submap; without it the map");
  command.add_option("--asset", options->assets, "only these of the server's assets");
  command.add_option("--up", options->up, "axis of the model that is up; without it y of glTF and z of others")
      ->check(CLI::IsMember({"x", "y", "z"}));
  command.add_option("--min-score", options->min_score, "0 to 1")->capture_default_str()->check(CLI::Range(0.0, 1.0));
}

}  // namespace concord
