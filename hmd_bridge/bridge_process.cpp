#include "bridge_process.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <spdlog/spdlog.h>

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

StaticFiles load_files(const std::filesystem::path& web) {
  StaticFiles files;
  if (const auto added = files.add(web, "/"); !added) {
    spdlog::warn("no web client: {}; build it with ./run build, clients of other kinds may connect", added.error().message);
    const auto page = std::make_shared<const std::string>(
        "<!doctype html><title>Concord</title><p>The bridge runs; its web client was not built."
        " See hmd_bridge/README.md.");
    files.add("/index.html", {"text/html; charset=utf-8", page});
  }
  return files;
}

Server::Config server_config(const Site& site) {
  Server::Config config;
  config.listen = site.bridge.listen;
  config.port = static_cast<std::uint16_t>(site.bridge.port);
  config.tls = site.bridge.tls;
  config.certificate = certificate_file(site);
  config.key = key_file(site);
  config.origins = site.bridge.origins;
  return config;
}

}  // namespace

class BridgeProcess::Parts {
 public:
  Parts(const NodeContext& context, const std::filesystem::path& web)
      : gate(random_secret),
        tokens(token_file(context.site)),
        files(load_files(web)),
        node(context, gate, hub_config(context.site)),
        server(io, node.hub(), gate, tokens, files, server_config(context.site), [&bus = context.bus] { return bus.now(); }) {}

  asio::io_context io{1};
  Gate gate;
  TokenStore tokens;
  StaticFiles files;
  BridgeNode node;
  Server server;
  std::unique_ptr<asio::posix::stream_descriptor> bus_ready;

  void watch(LcmBus& bus) {
    bus_ready->async_wait(asio::posix::stream_descriptor::wait_read, [this, &bus](const boost::system::error_code& error) {
      if (error) return;
      bus.spin_once(0);
      server.pump();
      watch(bus);
    });
  }
};

BridgeProcess::BridgeProcess(const NodeContext& context, const std::filesystem::path& web)
    : parts_(std::make_unique<Parts>(context, web)) {
  const Site::Bridge& bridge = context.site.bridge;
  spdlog::info("open {}://{}:{}/ in a browser or headset", bridge.tls ? "https" : "http", bridge.listen, parts_->server.port());
}

BridgeProcess::~BridgeProcess() {
  if (parts_->bus_ready) parts_->bus_ready->release();  // it is LCM's
  parts_->server.stop();
  parts_->io.run_for(kFarewell);
}

void BridgeProcess::wait(LcmBus& bus) {
  if (!parts_->bus_ready) {
    parts_->bus_ready = std::make_unique<asio::posix::stream_descriptor>(parts_->io, bus.descriptor());
    parts_->watch(bus);
  }
  parts_->io.run_one_for(kWait);
  parts_->io.poll();
  bus.spin_once(0);  // its timers
  parts_->server.pump();
}

std::uint16_t BridgeProcess::port() const { return parts_->server.port(); }

}  // namespace concord::hmd
