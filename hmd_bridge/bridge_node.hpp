#pragma once

#include <memory>

#include "access/gate.hpp"
#include "bridge/desk.hpp"
#include "bridge/own_maps.hpp"
#include "bus/process.hpp"

namespace concord::hmd {

/// The bridge between the bus and its clients, whatever carries them: a server feeds the hub, a test may too.
class BridgeNode {
 public:
  /// @param how looks of headsets are judged: beside the loop (async), or within it (deferred), where time stands
  /// still.
  /// @param models the address below which NAME.glb is an asset's model, for who is told of it.
  BridgeNode(const NodeContext& context, Gate& gate, const Hub::Config& config, std::launch how,
             std::string models = "/models/", const MapLimits& limits = {});
  BridgeNode(const BridgeNode&) = delete;
  BridgeNode& operator=(const BridgeNode&) = delete;

  [[nodiscard]] Hub& hub() { return hub_; }
  [[nodiscard]] World& world() { return world_; }

 private:
  [[nodiscard]] Hub::Handlers handlers();
  void tell_ended(const concord::Path& path);
  void tell_silent();
  void tell_no_path(Session& session, const std::string& robot);
  void on_path(const concord::Path& path);
  void hear_parts();

  NodeContext context_;
  Hub hub_;
  World world_;
  Asker asker_;
  Desk desk_;
  OwnMaps own_maps_;
};

/// What the site file says of clients, for the hub.
[[nodiscard]] Hub::Config hub_config(const Site& site);

}  // namespace concord::hmd
