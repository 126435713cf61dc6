#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "bus/brick_stream.hpp"
#include "bus/process.hpp"
#include "core/agent_layer.hpp"

namespace concord {

/// A copy of every agent's submap, and where each lies: hears `out/agent/AGENT` and `out/agents`.
class LayersNode {
 public:
  explicit LayersNode(const NodeContext& context);
  LayersNode(const LayersNode&) = delete;
  LayersNode& operator=(const LayersNode&) = delete;

  /// As they are now.
  [[nodiscard]] const AgentLayers& now();
  /// Whoever merge knows to have sent a submap is here, so that who is not here is nowhere; or that takes too long.
  [[nodiscard]] bool settled() const;
  /// Whether anybody is in the map, be it without a submap; nullopt: merge has not said it yet.
  [[nodiscard]] std::optional<bool> map_is_founded() const;

 private:
  [[nodiscard]] BrickReceiver* stream_of_channel(const std::string& channel, bool may_begin);
  [[nodiscard]] std::unique_ptr<BrickReceiver> make_receiver(const std::string& id);
  static void place(const std::string& id, AgentLayer& layer, const AgentList& list);
  void on_agents(const AgentList& list);

  NodeContext context_;
  std::int64_t start_;
  AgentLayers layers_;
  std::optional<AgentList> list_;  ///< the last
  std::map<std::string, std::unique_ptr<BrickReceiver>> streams_;
};

}  // namespace concord
