#pragma once

#include <filesystem>
#include <memory>

#include "bus/process.hpp"

namespace concord {
class LcmBus;
}

namespace concord::hmd {

/// The bridge as a process: the node, the server in front of it, one loop for both.
class BridgeProcess {
 public:
  /// `web`: the folder of the built web client. @throws ConfigError for what of the site file cannot be used.
  BridgeProcess(const NodeContext& context, const std::filesystem::path& web);
  ~BridgeProcess();
  BridgeProcess(const BridgeProcess&) = delete;
  BridgeProcess& operator=(const BridgeProcess&) = delete;

  /// Waits some milliseconds for clients and for the bus, and serves both.
  void wait(LcmBus& bus);
  [[nodiscard]] std::uint16_t port() const;

 private:
  class Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace concord::hmd
