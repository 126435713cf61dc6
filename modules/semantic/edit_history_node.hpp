#pragma once

#include <functional>
#include <map>
#include <string>

#include "bus/messages.hpp"
#include "bus/process.hpp"

namespace concord {

/// Follows what merge did to the map. Its history is asked for what is after the revision that is known, whenever merge
/// has answered somebody or its status shows a later one.
class EditHistoryNode {
 public:
  struct Events {
    /// In the order of their revisions; all of them, since the map began.
    std::function<void(const Operation&)> on_operation;
    /// All was told that one answer had.
    std::function<void()> on_told;
  };

  EditHistoryNode(const NodeContext& context, Events events);
  EditHistoryNode(const EditHistoryNode&) = delete;
  EditHistoryNode& operator=(const EditHistoryNode&) = delete;

  /// Whether all is known that merge has said it holds.
  [[nodiscard]] bool is_up_to_date() const { return heard_revision_ >= 0 && known_revision_ >= heard_revision_; }

  /// Null: no edit that deletes voxels has this id, as far as is known.
  [[nodiscard]] const Operation* find_deletion(const std::string& id) const;

 private:
  void on_answer(const Answer& answer);
  void on_part(const HistoryPart& part);
  void ask();

  NodeContext context_;
  Events events_;
  std::map<std::string, Operation> deletions_;
  std::int64_t known_revision_ = 0;
  std::int64_t heard_revision_ = -1;  ///< by merge's status
  std::int64_t asked_revision_ = -1;  ///< what was heard when it was asked last: the answer reaches as far
  bool has_news_ = false;             ///< merge has answered somebody since it was asked last
  std::string question_;              ///< what the ids of our questions begin with
  std::int64_t questions_ = 0;
  std::string open_;  ///< the id of the question that is open; empty: none
  std::map<std::int32_t, HistoryPart> parts_;
};

}  // namespace concord
