#include "bridge_process.hpp"

#include <fstream>

#include <spdlog/spdlog.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "access/site_files.hpp"
#include "access/token_store.hpp"
#include "bridge_node.hpp"
#include "bus/lcm_bus.hpp"
#include "server/server.hpp"

namespace concord::hmd {
namespace {

namespace asio = boost::asio;

constexpr std::chrono::milliseconds kWait(5);  ///< the bus's timers are due to so much
constexpr std::chrono::milliseconds kFarewell(300);
constexpr std::int64_t kTokens = 5'000'000;  ///< microseconds: so soon who has lost their token is out
constexpr int kTurns = 8;                    ///< of clients, between two of the bus

/// Where models are is told to who may know it, and changes with each start.
std::string models_address() { return "/models/" + random_secret() + "/"; }

StaticFiles load_files(const std::filesystem::path& web) {
  StaticFiles files;
  if (const auto added = files.add(web, "/"); !added) {
    spdlog::warn("no web client: {}; build it with ./run build, clients of other kinds may connect",
                 added.error().message);
    const auto page = std::make_shared<const std::string>(
        "<!doctype html><title>Concord</title><p>The bridge runs; its web client was not built."
        " See hmd_bridge/README.md.");
    files.add("/index.html", {"text/html; charset=utf-8", page, {}});
  }
  return files;
}

Server::Config server_config(const Site& site, std::optional<int> listener) {
  Server::Config config;
  config.listen = site.bridge.listen;
  config.port = static_cast<std::uint16_t>(site.bridge.port);
  config.tls = site.bridge.tls;
  config.certificate = certificate_file(site);
  config.key = key_file(site);
  config.origins = site.bridge.origins;
  config.listener = listener;
  return config;
}

}  // namespace

class BridgeProcess::Parts {
 public:
  Parts(const NodeContext& context, const Options& options)
      : gate(random_secret),
        tokens(token_file(context.site)),
        files(load_files(options.web)),
        models(models_address()),
        node(context, gate, hub_config(context.site), std::launch::async, models),
        server(io, node.hub(), gate, tokens, files, server_config(context.site, options.listener),
               [&bus = context.bus] { return bus.now(); }) {
    files.serve_models(models, context.site.state / "assets" / "gltf");
    context.bus.every(kTokens, [this] { node.hub().keep_only([this](const Identity& who) { return holds(who); }); });
  }

  asio::io_context io{1};
  Gate gate;
  TokenStore tokens;
  StaticFiles files;
  std::string models;
  BridgeNode node;
  Server server;
  std::unique_ptr<asio::posix::stream_descriptor> bus_ready;

  /// Tokens that cannot be read just now are as they were.
  bool holds(const Identity& who) { return tokens.holds(who).value_or(true); }

  void watch(LcmBus& bus) {
    bus_ready->async_wait(asio::posix::stream_descriptor::wait_read,
                          [this, &bus](const boost::system::error_code& error) {
                            if (error) return;
                            bus.spin_once(0);
                            server.pump();
                            watch(bus);
                          });
  }
};

BridgeProcess::BridgeProcess(const NodeContext& context, const Options& options)
    : parts_(std::make_unique<Parts>(context, options)), address_file_(address_file(context.site)) {
  const std::vector<std::string> addresses = parts_->server.addresses();
  std::error_code ignored;  // what could not be made cannot be written either
  std::filesystem::create_directories(address_file_.parent_path(), ignored);
  std::ofstream out(address_file_);
  if (!(out << addresses.front() << "\n" << addresses.back() << "\n").flush()) {
    throw ConfigError("cannot write " + address_file_.string());
  }
  spdlog::info("open {} in a browser or headset", addresses.front());
}

BridgeProcess::~BridgeProcess() {
  if (parts_->bus_ready) parts_->bus_ready->release();  // it is LCM's
  parts_->server.stop();
  parts_->io.run_for(kFarewell);
  std::error_code ignored;
  std::filesystem::remove(address_file_, ignored);
}

void BridgeProcess::wait(LcmBus& bus) {
  if (!parts_->bus_ready) {
    parts_->bus_ready = std::make_unique<asio::posix::stream_descriptor>(parts_->io, bus.descriptor());
    parts_->watch(bus);
  }
  parts_->io.run_one_for(kWait);
  // Clients that take all they can get always have more to do: the bus gets its turn all the same.
  for (int turn = 0; turn < kTurns && parts_->io.poll_one() > 0; ++turn) {
  }
  bus.spin_once(0);  // its timers
  parts_->server.pump();
}

}  // namespace concord::hmd
