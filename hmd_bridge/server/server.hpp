#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "access/gate.hpp"
#include "access/token_store.hpp"
#include "server/static_files.hpp"
#include "session/hub.hpp"

namespace boost::asio {
class io_context;
}

namespace concord::hmd {

/// HTTPS and WSS in front of a hub. All of it runs in the io_context's one thread. Beast stays behind this header.
class Server {
 public:
  struct Config {
    std::string listen = "127.0.0.1";
    std::uint16_t port = 0;            ///< 0: any that is free
    std::optional<int> listener = {};  ///< descriptor of a listening TCP socket that is served beside its own
    bool tls = true;
    std::filesystem::path certificate, key;
    std::vector<std::string> origins;
    std::size_t max_connections = 512;             ///< whatever they do; some are kept for this machine
    std::size_t max_connections_per_address = 64;  ///< from other machines
    double header_seconds = 10;                    ///< a whole request's header and body
    double idle_seconds = 30;                      ///< of a WebSocket
    double close_seconds = 5;                      ///< until one that does not close is cut
  };

  /// @throws ConfigError for an address, a listener or a certificate that cannot be used. `now` is the stack's clock.
  Server(boost::asio::io_context& io, Hub& hub, Gate& gate, TokenStore& tokens, const StaticFiles& files, Config config,
         std::function<std::int64_t()> now);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] std::uint16_t port() const;
  /// Where it is reached, for a browser; that of the given listener first.
  [[nodiscard]] std::vector<std::string> addresses() const;
  /// Writes what the hub has for clients. Call it whenever the hub was given something.
  void pump();
  /// Accepts nobody any more, and says bye.
  void stop();

  class Core;

 private:
  std::shared_ptr<Core> core_;
};

}  // namespace concord::hmd
