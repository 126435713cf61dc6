#pragma once

#include <future>
#include <map>
#include <optional>
#include <string>

#include "bus/brick_stream.hpp"
#include "bus/layers_node.hpp"
#include "bus/messages_label.hpp"
#include "bus/process.hpp"
#include "bus/replies.hpp"
#include "bus/reply_queue.hpp"
#include "semantic/assets/assets_node.hpp"
#include "semantic/detections/detections_node.hpp"
#include "semantic/labels/label_files_node.hpp"
#include "semantic/labels/label_view.hpp"
#include "semantic/labels/labels.hpp"
#include "semantic/labels/margins_node.hpp"
#include "semantic/map_selection.hpp"
#include "semantic/semantic_store.hpp"

namespace concord {

/// The semantic process: hears the map and what people say of it; says which voxels show which label.
class SemanticNode {
 public:
  /// @param how deferred: what is worked out of models takes no time of the bus's.
  /// @throws std::runtime_error if its store cannot be opened or was damaged.
  SemanticNode(const NodeContext& context, std::launch how);

  [[nodiscard]] const LabelView& view() const { return view_; }

 private:
  void listen_to_the_map();
  void restore();
  void on_agents(const AgentList& list);
  void on_request(const LabelRequest& request);
  void on_delete(const LabelRequest& request, std::uint64_t content);
  [[nodiscard]] Result<void> send_deletion(const LabelRequest& request, std::uint64_t content);
  [[nodiscard]] Result<EditRequest> deletion_of(const LabelRequest& request) const;
  void on_query(const LabelQuery& query);
  [[nodiscard]] bool repeat(const LabelRequest& request, std::uint64_t content);
  [[nodiscard]] Result<Labels::What> check(const LabelRequest& request);
  [[nodiscard]] Result<void> commit(const std::string& id, const std::string& author, std::uint64_t content,
                                    Labels::What what);
  [[nodiscard]] Result<void> commit(const std::vector<LabelCorrection>& corrections);
  void grant(const std::string& id, const Labels::Made& made, const std::string& message);
  void refresh(const BrickSet& touched);
  void tell_slots();
  [[nodiscard]] bool is_whole();

  NodeContext context_;
  Replies replies_;
  SemanticStore store_;
  LayersNode layers_;
  Labels labels_;
  BrickMap map_;
  LabelView view_;
  MapSelection selection_;
  BrickReceiver map_receiver_;
  BrickSender label_stream_;
  ListSender<LabelSlot> slot_list_;
  ReplyQueue queue_;
  BrickSet dirty_;  ///< the map changed there
  bool has_new_slots_ = true;
  bool begun_ = false;
  bool is_whole_ = false;  ///< since this start, once
  BrickSet edited_;        ///< what merge did changes there what holds
  EditHistoryNode history_node_;
  AssetsNode assets_node_;
  DetectionsNode detections_node_;
  LabelFilesNode files_node_;
  MarginsNode margins_node_;
};

}  // namespace concord
