#pragma once

#include <future>
#include <map>
#include <memory>

#include "bus/brick_stream.hpp"
#include "bus/list_stream.hpp"
#include "bus/process.hpp"
#include "planner/blamed_edits_node.hpp"
#include "planner/planner.hpp"
#include "planner/watches_node.hpp"

namespace concord {

/// The planner on the bus: hears the map, the zones, poses and path requests; says the grid, paths and answers.
class PlannerNode {
 public:
  /// `how` searches that may take seconds are made: beside the bus (async), or within it (deferred), where time stands
  /// still.
  /// @throws ConfigError for a height band that holds no voxel, and for a footprint that is none.
  PlannerNode(const NodeContext& context, std::launch how);
  /// Ends what is being searched.
  ~PlannerNode();
  PlannerNode(const PlannerNode&) = delete;
  PlannerNode& operator=(const PlannerNode&) = delete;

  [[nodiscard]] const Planner& planner() const { return planner_; }
  [[nodiscard]] const BrickReceiver& map() const { return receiver_; }
  [[nodiscard]] const ListReceiver<Zone>& zones() const { return zones_; }

 private:
  void on_frame(const std::string& frame_id);
  void on_zones();
  void on_agents(const AgentList& list);
  void on_request(const PathRequest& request);
  void cancel(const PathRequest& request);
  void on_watch(const std::string& channel, const PathWatch& watch);
  void project();
  void go_on();
  void speak();
  void reply(const Planner::Reply& reply);
  void publish(const Path& path);
  void blame(const Path& path);
  [[nodiscard]] Robot robot(const std::string& id) const;
  [[nodiscard]] Planner::Moment moment() const;

  NodeContext context_;
  Planner planner_;
  BrickSender sender_;
  BrickReceiver receiver_;
  ListReceiver<Zone> zones_;
  ListReceiver<Zone> label_zones_;  ///< around things that robots keep away from; none while semantic has said none
  WatchesNode watches_;
  BlamedEditsNode blamed_;
  std::int64_t map_heard_ = 0;
  std::launch how_;
  std::map<std::string, Body> bodies_;  ///< of agents that the site file gives one
  std::optional<Body> unlisted_;
  std::shared_ptr<PoseQuest> quest_;
  std::future<void> search_;  ///< of it; ends before all else
};

}  // namespace concord
