#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "bus/process.hpp"

namespace concord {
class LcmBus;
}

namespace concord::hmd {

/// The bridge as a process: the node, the server in front of it, one loop for both.
class BridgeProcess {
 public:
  struct Options {
    std::filesystem::path web;         ///< the folder of the built web client
    std::optional<int> listener = {};  ///< Server::Config::listener
  };
  /// @throws ConfigError for what of the site file cannot be used.
  BridgeProcess(const NodeContext& context, const Options& options);
  ~BridgeProcess();
  BridgeProcess(const BridgeProcess&) = delete;
  BridgeProcess& operator=(const BridgeProcess&) = delete;

  /// Waits some milliseconds for clients and for the bus, and serves both.
  void wait(LcmBus& bus);

 private:
  class Parts;
  std::unique_ptr<Parts> parts_;
  std::filesystem::path address_file_;
};

}  // namespace concord::hmd
