#include "bus/process.hpp"

#include <atomic>
#include <csignal>

#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include "bus/lcm_bus.hpp"
#include "bus/messages.hpp"

namespace concord {
namespace {

std::atomic<bool> stop_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free, "it is set in a signal handler");

void stop_on_signals() {
  struct sigaction action = {};
  action.sa_handler = [](int) { stop_requested = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

void serve(const std::string& process, const Site& site,
           const std::function<std::shared_ptr<void>(const NodeContext&)>& make,
           const std::function<void(const std::shared_ptr<void>&, LcmBus&)>& wait) {
  Counters counters;
  LcmBus bus(site.lcm_url, counters);
  const std::int64_t boot_id = bus.now();
  const NodeContext context{bus, counters, site, process, boot_id};
  publish_status_each_second(context);
  const std::shared_ptr<void> node = make(context);
  spdlog::info("serving on {}", site.lcm_url);
  while (!stop_requested) {
    if (wait) {
      wait(node, bus);
    } else {
      bus.spin_once(10);
    }
  }
  spdlog::info("stopping");
}

/// The site that `--site` names on the command line; all else there is left to the process's own parser.
Site load_named_site(int argc, char** argv) {
  CLI::App app;
  app.set_help_flag();
  app.allow_extras();
  std::string file;
  app.add_option("--site", file);
  app.parse(argc, argv);
  return file.empty() ? Site{} : load_site(file);
}

}  // namespace

void publish_status_each_second(const NodeContext& context) {
  context.bus.every(1'000'000, [context] {
    const ProcessStatus status{context.bus.now(), context.process, context.boot_id, context.counters.all()};
    context.bus.publish("out/status/" + context.process, encode(status));
  });
}

int run_process(const std::string& process, int argc, char** argv,
                const std::function<std::shared_ptr<void>(const NodeContext&)>& make,
                const std::function<void(CLI::App&, Site&)>& add_options,
                const std::function<void(const std::shared_ptr<void>&, LcmBus&)>& wait) {
  spdlog::set_pattern("%H:%M:%S.%e " + process + " %^%l%$ %v");
  try {
    // The site file first: the options that follow write over it.
    Site site = load_named_site(argc, argv);
    CLI::App app("Concord's " + process + " process");
    std::string site_file;
    app.add_option("--site", site_file, "the site's YAML file; defaults hold where it is silent");
    if (add_options) add_options(app, site);
    try {
      app.parse(argc, argv);
    } catch (const CLI::Success& e) {  // help was asked for
      return app.exit(e);
    }
    spdlog::info("effective configuration:\n{}", to_yaml(site));
    stop_on_signals();
    serve(process, site, make, wait);
    return 0;
  } catch (const CLI::ParseError& e) {
    spdlog::error("{}; see --help", e.what());
    return 2;
  } catch (const ConfigError& e) {
    spdlog::error("{}", e.what());
    return 2;
  } catch (const std::exception& e) {
    spdlog::error("{}", e.what());
    return 1;
  }
}

}  // namespace concord
