#pragma once

#include "bus/process.hpp"
#include "merge/agents_node.hpp"
#include "merge/map_streams.hpp"
#include "merge/maps_node.hpp"
#include "merge/merge_store.hpp"
#include "merge/people.hpp"
#include "merge/people_node.hpp"
#include "merge/reports_node.hpp"

namespace concord {

/// The merge process: hears the agents' streams and what people ask for; says the map, its conflicts, zones, leases and
/// who is where.
class MergeNode {
 public:
  /// @throws std::runtime_error if its store cannot be opened or was damaged.
  explicit MergeNode(const NodeContext& context);

  [[nodiscard]] const BrickMap& map() const { return map_.layers().map(); }
  [[nodiscard]] const BrickMap& conflicts() const { return map_.layers().conflicts(); }

 private:
  [[nodiscard]] People restored();
  void settle();
  void refold_and_send();
  void count();

  NodeContext context_;
  MergeStore store_;
  People people_;
  MapStreams map_;
  AgentsNode agents_;
  PeopleNode people_node_;
  MapsNode maps_node_;
  ReportsNode reports_node_;
};

}  // namespace concord
