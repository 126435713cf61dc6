#pragma once

#include <functional>
#include <memory>
#include <string>

#include "bus/bus.hpp"
#include "bus/counters.hpp"
#include "bus/site.hpp"

namespace CLI {
class App;
}

namespace concord {

class LcmBus;

/// What a node is given by its shell.
struct NodeContext {
  Bus& bus;
  Counters& counters;
  const Site& site;
  std::string process;   ///< its name, for answers and status
  std::int64_t boot_id;  ///< this start, microseconds since 1970
};

/// A status message each second on out/status/<process>: that it lives, and what it has counted.
void publish_status_each_second(const NodeContext& context);

/// Runs a node as an LCM process: `--site FILE`, signals, a status message each second on out/status/<process>,
/// until SIGINT or SIGTERM. `make` builds the node and returns it type-erased; it lives until the end.
/// `add_options` may add options of the process's own that write into the site, over the file's values.
/// `wait` is called again and again with the node instead of `bus.spin_once(10)`, by a node that waits for more than
/// the bus; it spins the bus itself. Returns the exit code: 0 after a signal, 2 for a configuration that cannot be
/// used, 1 for what may be better at the next start.
[[nodiscard]] int run_process(const std::string& process, int argc, char** argv,
                              const std::function<std::shared_ptr<void>(const NodeContext&)>& make,
                              const std::function<void(CLI::App&, Site&)>& add_options = {},
                              const std::function<void(const std::shared_ptr<void>&, LcmBus&)>& wait = {});

}  // namespace concord
