#pragma once

#include "bus/process.hpp"
#include "bus/recent_answers.hpp"
#include "merge/map_store.hpp"
#include "merge/map_streams.hpp"
#include "merge/people_node.hpp"
#include "merge/replies.hpp"

namespace concord {

/// Saves and lists maps.
class MapsNode {
 public:
  MapsNode(const NodeContext& context, MapStreams& map, PeopleNode& people);
  MapsNode(const MapsNode&) = delete;
  MapsNode& operator=(const MapsNode&) = delete;

 private:
  void save(const MapRequest& request);
  void list(const MapRequest& request);

  NodeContext context_;
  MapStreams& map_;
  PeopleNode& people_;
  Replies replies_;
  MapStore maps_;
  RecentAnswers answers_;
};

}  // namespace concord
