#include "rig.hpp"

#include <stdlib.h>

#include <atomic>
#include <fstream>
#include <future>
#include <thread>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "access/certificate.hpp"
#include "bus/lcm_bus.hpp"

namespace concord::hmd {

class Rig::Parts {
 public:
  explicit Parts(const Options& options) : tokens(make_folder() / "tokens.db") {
    const Certificate made = make_certificate({"localhost"}, std::time(nullptr)).value();
    std::ofstream(folder / "cert.pem") << made.certificate;
    std::ofstream(folder / "key.pem") << made.key;
    std::filesystem::create_directories(folder / "web");
    std::filesystem::create_directories(folder / "models");
    std::ofstream(folder / "web" / "index.html") << "<!doctype html><title>page</title>";
    std::ofstream(folder / "secret.txt") << "secret";
    std::future<void> up = ready.get_future();
    thread = std::thread([this, options] { run(options); });
    up.get();
  }
  ~Parts() {
    stop = true;
    thread.join();
    std::filesystem::remove_all(folder);
  }

  std::filesystem::path make_folder() {
    std::string pattern = "/dev/shm/concord-rig-XXXXXX";
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no /dev/shm");
    return folder = pattern;
  }

  void run(const Options& options) {
    site.state = folder;
    Counters counters;
    LcmBus bus("memq://", counters);
    const auto context = [&](const char* process) { return NodeContext{bus, counters, site, process, bus.now()}; };
    const std::shared_ptr<void> others = options.others ? options.others(context("others")) : nullptr;
    Gate gate(random_secret);
    Hub::Config hub = hub_config(site);
    hub.local_role = options.local_role;
    BridgeNode node(context("hmd-bridge"), gate, hub, std::launch::async);
    StaticFiles files;
    (void)files.add(folder / "web", "/");
    files.serve_models("/models/", folder / "models");
    Server::Config config;
    config.certificate = folder / "cert.pem";
    config.key = folder / "key.pem";
    config.header_seconds = options.header_seconds;
    config.idle_seconds = options.idle_seconds;
    config.close_seconds = options.close_seconds;
    config.listener = options.listener;
    config.origins = {"https://lab.example"};
    Server server(io, node.hub(), gate, tokens, files, config, [&bus] { return bus.now(); });
    port = server.port();
    the_node = &node;
    the_bus = &bus;
    ready.set_value();
    while (!stop) {
      io.run_one_for(std::chrono::milliseconds(1));
      for (int turn = 0; turn < 8 && io.poll_one() > 0; ++turn) {
      }
      bus.spin_once(0);
      server.pump();
      if (awaited && awaited(node)) {
        awaited = nullptr;
        reached.set_value();
      }
    }
    server.stop();
    io.run_for(std::chrono::milliseconds(50));
  }

  std::filesystem::path folder;
  TokenStore tokens;
  Site site;
  boost::asio::io_context io{1};
  std::atomic<bool> stop = false;
  std::uint16_t port = 0;
  BridgeNode* the_node = nullptr;
  Bus* the_bus = nullptr;
  std::function<bool(BridgeNode&)> awaited;  ///< looked at in the server's thread
  std::promise<void> ready, reached;
  std::thread thread;
};

Rig::Rig(const Options& options) : parts_(std::make_unique<Parts>(options)) {}
Rig::~Rig() = default;
std::uint16_t Rig::port() const { return parts_->port; }
const std::filesystem::path& Rig::folder() const { return parts_->folder; }
TokenStore& Rig::tokens() { return parts_->tokens; }

void Rig::in_server(const std::function<void(BridgeNode&, Bus&)>& what) {
  const auto done = std::make_shared<std::promise<void>>();
  boost::asio::post(parts_->io, [&, done] {
    what(*parts_->the_node, *parts_->the_bus);
    done->set_value();
  });
  done->get_future().get();
}

void Rig::wait_for(const std::function<bool(BridgeNode&)>& done) {
  std::future<void> reached;
  in_server([&](BridgeNode&, Bus&) {
    parts_->reached = {};
    reached = parts_->reached.get_future();
    parts_->awaited = done;
  });
  reached.get();
}

}  // namespace concord::hmd
