#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>

#include "bus/messages_asset.hpp"
#include "bus/process.hpp"
#include "bus/replies.hpp"
#include "semantic/labels.hpp"

namespace concord {

/// Puts models into the map. The intent is stored first: a label of the model's voxels that holds while the edit
/// asset-ID does. Then the edit is sent to merge, again each second until merge has answered, also after a restart of
/// either. Who undoes that edit undoes the injection, label and all.
///
/// Which edits hold is merge's to say: its history is asked for what is after the revision that is known, whenever
/// merge's answers or its status show a later one.
class AssetsNode {
 public:
  struct Parts {
    Labels& labels;
    /// Stores and applies a label correction. Refused: kIo.
    std::function<Result<void>(const std::string& id, const std::string& author, std::uint64_t content, Labels::What)>
        commit;
    std::function<void(const BrickSet&)> refresh;
  };

  AssetsNode(const NodeContext& context, Parts parts);
  AssetsNode(const AssetsNode&) = delete;
  AssetsNode& operator=(const AssetsNode&) = delete;

 private:
  void on_request(const AssetRequest& request);
  [[nodiscard]] Result<LabelCorrection::Claim> claim_of(const AssetRequest& request) const;
  void on_answer(const Answer& answer);
  void on_history(const HistoryPart& part);
  void ask_history();
  void take_back(const Labels::Waiting& refused, const Answer& why);
  void answer_askers();
  void send_waiting();
  void list();

  NodeContext context_;
  Parts parts_;
  Replies replies_;
  ListSender<Asset> list_;
  std::map<std::string, Asset> assets_;
  std::set<std::string> asked_;       ///< requests whose askers wait for an answer
  std::int64_t known_revision_ = 0;   ///< of merge's history
  std::int64_t heard_revision_ = -1;  ///< the highest that merge has spoken of
  std::string history_id_;            ///< of the question that is open; empty: none
  std::map<std::int32_t, HistoryPart> history_;
};

}  // namespace concord
