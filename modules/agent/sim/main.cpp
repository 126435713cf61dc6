#include <map>

#include <CLI/CLI.hpp>

#include "agent/sim/sim_node.hpp"

namespace {

void add_options(CLI::App& app, concord::SimNode::Config& config) {
  static const std::map<std::string, concord::AgentKind> kKinds{{"lidar", concord::AgentKind::kLidar},
                                                                {"camera", concord::AgentKind::kCamera},
                                                                {"headset", concord::AgentKind::kHeadset}};
  const auto named = [](const std::string& text) {
    return concord::is_name(text) ? "" : "an id is 1 to 40 letters, digits, dots, dashes, underscores";
  };
  app.add_option("--agent", config.agent, "its id in the site file")->check(named);
  app.add_option("--kind", config.kind, "lidar, camera or headset")->transform(CLI::CheckedTransformer(kKinds));
  app.add_option("--seed", config.seed, "of the warehouse: the same for all agents");
  app.add_option("--speed", config.speed, "simulated seconds in a second")->check(CLI::Range(0.1, 100.0));
  app.add_flag("--leave", config.leave, "end some seconds after the end of the way");
}

/// The process is named after its agent, which is known only from the options: read ahead.
/// Mistakes are found when the process reads them again.
std::string agent_in(int argc, char** argv) {
  CLI::App app;
  app.allow_extras();
  app.set_help_flag();
  std::string agent = concord::SimNode::Config().agent;
  app.add_option("--agent", agent);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError&) {
    agent = "agent";
  }
  return agent;
}

}  // namespace

int main(int argc, char** argv) {
  concord::SimNode::Config config;
  return concord::run_process(
      "sim-" + agent_in(argc, argv), argc, argv,
      [&config](const concord::NodeContext& context) { return std::make_shared<concord::SimNode>(context, config); },
      [&config](CLI::App& app, concord::Site&) { add_options(app, config); });
}
