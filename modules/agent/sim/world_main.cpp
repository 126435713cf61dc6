#include <iostream>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "agent/sim/score.hpp"
#include "agent/sim/trajectory.hpp"
#include "core/octomap_reader.hpp"
#include "store/whole_file.hpp"

namespace {

using nlohmann::ordered_json;

ordered_json to_json(const concord::Transform& T) {
  const Eigen::Quaterniond q(T.linear());
  const Eigen::Vector3d& p = T.translation();
  return {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
}

/// What a script must know to play a person in the warehouse.
ordered_json describe(const concord::World& world) {
  ordered_json agents, features = ordered_json::array();
  for (const char* kind : {"lidar", "camera", "headset"}) {
    const concord::AgentKind k = *concord::agent_kind(kind);
    agents[kind] = {{"T_map_agent", to_json(concord::start_pose(k))}, {"duration", concord::Trajectory(k).duration()}};
  }
  for (const concord::Feature& feature : world.features) {
    features.push_back({{"name", feature.name}});
    if (!feature.edit_box) continue;
    const Eigen::Vector3d &low = feature.edit_box->min(), &high = feature.edit_box->max();
    features.back()["edit_box"] = {low.x(), low.y(), low.z(), high.x(), high.y(), high.z()};
  }
  const Eigen::Vector2d &from = world.through_glass.from, &to = world.through_glass.to;
  const ordered_json errand = {{"from", {from.x(), from.y()}}, {"to", {to.x(), to.y()}}};
  return {{"agents", agents}, {"features", features}, {"through_glass", errand}};
}

ordered_json to_json(const concord::MapScore& score) {
  ordered_json features = ordered_json::array();
  for (const concord::FeatureScore& feature : score.features) {
    features.push_back({{"name", feature.name}, {"share", feature.share}, {"found", feature.found}});
  }
  return {{"precision", score.precision}, {"recall", score.recall}, {"features", features}};
}

concord::Result<concord::OctomapImport> load(const std::string& path) {
  const concord::OctomapLimits limits;
  return concord::read_whole_file(path, limits.bytes).and_then([&](const concord::Bytes& bytes) {
    return concord::read_octomap_file(bytes, std::nullopt, limits);
  });
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("The simulated warehouse, as JSON: what stands where, and how well a map shows it");
  std::uint64_t seed = 1;
  std::string path;
  app.add_option("--seed", seed, "of the warehouse");
  app.require_subcommand(1);
  app.add_subcommand("describe", "the agents' start poses (x y z qx qy qz qw), what to edit, an errand through glass");
  CLI::App* score = app.add_subcommand("score", "precision and recall of a map in the warehouse's frame");
  score->add_option("map", path, ".bt or .ot file")->required()->check(CLI::ExistingFile);
  CLI11_PARSE(app, argc, argv);

  const concord::World world = concord::make_warehouse(seed);
  if (!score->parsed()) {
    std::cout << describe(world).dump(2) << '\n';
    return 0;
  }
  const concord::Result<concord::OctomapImport> import = load(path);
  if (!import) {
    std::cerr << path << ": " << import.error().message << '\n';
    return 1;
  }
  const concord::Truth truth = concord::make_truth(world, import->resolution);
  std::cout << to_json(concord::score(import->map, truth)).dump(2) << '\n';
  return 0;
}
