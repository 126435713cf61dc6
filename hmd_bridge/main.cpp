#include <filesystem>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "bridge_process.hpp"
#include "bus/lcm_bus.hpp"

int main(int argc, char** argv) {
  using concord::hmd::BridgeProcess;
  BridgeProcess::Options options;
  options.web = std::filesystem::read_symlink("/proc/self/exe").parent_path() / ".." / "web";
  return concord::run_process(
      "hmd-bridge", argc, argv,
      [&](const concord::NodeContext& context) -> std::shared_ptr<void> {
        return std::make_shared<BridgeProcess>(context, options);
      },
      [&](CLI::App& app, concord::Site& site) {
        app.add_option("--web", options.web, "folder of the built web client");
        app.add_option("--port", site.bridge.port, "over the site file's")->check(CLI::Range(0, 65535));
        app.add_option("--listener", options.listener, "descriptor of a listening socket to serve as well")
            ->envname("CONCORD_BRIDGE_LISTENER");
      },
      [](const std::shared_ptr<void>& node, concord::LcmBus& bus) {
        static_cast<BridgeProcess*>(node.get())->wait(bus);
      });
}
