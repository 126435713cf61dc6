#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "bridge_node.hpp"
#include "server/server.hpp"

namespace concord::hmd {

/// The bridge's node and server in a thread of their own, on memq://, with TLS on a free port.
class Rig {
 public:
  struct Options {
    double header_seconds = 10, idle_seconds = 30, close_seconds = 5;
    Role local_role = Role::kEdit;
    /// More processes on the same bus, made in the server's thread.
    std::function<std::shared_ptr<void>(const NodeContext&)> others;
    std::optional<int> listener = {};  ///< Server::Config::listener
  };
  explicit Rig(const Options& options);
  Rig() : Rig(Options{}) {}
  ~Rig();
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  [[nodiscard]] std::uint16_t port() const;
  /// Runs something in the server's thread, and waits for it.
  void in_server(const std::function<void(BridgeNode&, Bus&)>& what);
  /// Returns once `done` holds in the server's thread, where it is looked at after everything that happens.
  void wait_for(const std::function<bool(BridgeNode&)>& done);
  [[nodiscard]] const std::filesystem::path& folder() const;
  [[nodiscard]] TokenStore& tokens();

 private:
  class Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace concord::hmd
