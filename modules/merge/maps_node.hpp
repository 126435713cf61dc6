#pragma once

#include "bus/process.hpp"
#include "bus/recent_answers.hpp"
#include "bus/replies.hpp"
#include "core/correction_check.hpp"
#include "core/map_archive.hpp"
#include "merge/agents_node.hpp"
#include "merge/map_store.hpp"
#include "merge/map_streams.hpp"
#include "merge/merge_store.hpp"
#include "merge/people.hpp"
#include "merge/people_node.hpp"

namespace concord {

/// Saves, lists and loads maps. Of a map that is loaded merge takes what people corrected; its layers are ingest's.
class MapsNode {
 public:
  /// All of them must outlive this.
  struct Parts {
    MergeStore& store;
    const People& people;
    MapStreams& map;
    const AgentsNode& agents;
    PeopleNode& people_node;
  };
  MapsNode(const NodeContext& context, const Parts& parts);
  MapsNode(const MapsNode&) = delete;
  MapsNode& operator=(const MapsNode&) = delete;

 private:
  void save(const MapRequest& request);
  void list(const MapRequest& request);
  void load(const MapRequest& request);

  [[nodiscard]] Result<std::int64_t> write(const MapRequest& request);
  [[nodiscard]] Result<Bytes> encoded(const std::string& format);
  [[nodiscard]] Result<Bytes> archived();
  [[nodiscard]] Result<std::int64_t> take(const MapRequest& request);
  [[nodiscard]] Result<void> check_layers(const MapArchive& archive, std::int64_t incarnation) const;
  [[nodiscard]] Result<CorrectionCheck> check_of_ours();

  NodeContext context_;
  Parts parts_;
  Replies replies_;
  MapStore maps_;
  RecentAnswers answers_;
};

}  // namespace concord
