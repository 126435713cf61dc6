#pragma once

#include <memory>

#include "bus/brick_stream.hpp"
#include "bus/list_stream.hpp"
#include "bus/process.hpp"
#include "planner/planner.hpp"

namespace concord {

/// The planner on the bus: hears the map, the zones, poses and path requests; says the grid, paths and answers.
class PlannerNode {
 public:
  /// @throws ConfigError for a height band that holds no voxel.
  explicit PlannerNode(const NodeContext& context);

  [[nodiscard]] const Planner& planner() const { return planner_; }
  [[nodiscard]] const BrickReceiver& map() const { return receiver_; }
  [[nodiscard]] const ListReceiver<Zone>& zones() const { return zones_; }

 private:
  void on_frame(const std::string& frame_id);
  void on_zones();
  void on_request(const PathRequest& request);
  void project();
  void speak();
  void publish(const Path& path);
  [[nodiscard]] Planner::Moment moment() const;

  NodeContext context_;
  Planner planner_;
  BrickSender sender_;
  BrickReceiver receiver_;
  ListReceiver<Zone> zones_;
  ListReceiver<Zone> label_zones_;  ///< around things that robots keep away from; none while semantic has said none
};

}  // namespace concord
