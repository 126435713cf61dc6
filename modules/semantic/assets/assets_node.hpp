#pragma once

#include <functional>
#include <map>
#include <string>

#include "bus/messages_asset.hpp"
#include "bus/process.hpp"
#include "bus/replies.hpp"
#include "semantic/assets/gltf_store.hpp"
#include "semantic/labels/labels.hpp"

namespace concord {

/// Puts models into the map. The intent is stored first: a label of the model's voxels that holds while the edit
/// asset-ID does. Then the edit is sent to merge, again each second until merge has answered, also after a restart of
/// either. Who undoes that edit undoes the injection, label and all.
///
/// One that is moved is an edit in its new place and an undo of the one in its old (injections.hpp): the second is
/// asked for when merge has the first, each second until it is so; refused, the first is undone.
///
/// Which edits hold is merge's to say: its history is asked for what is after the revision that is known, whenever
/// merge has answered somebody or its status shows a later one.
class AssetsNode {
 public:
  struct Parts {
    Labels& labels;
    /// Stores and applies a label correction. Refused: kIo.
    std::function<Result<void>(const std::string& id, const std::string& author, std::uint64_t content, Labels::What)>
        commit;
    std::function<void(const BrickSet&)> refresh;
    /// How an instance shows in the map.
    std::function<LabelInstance(InstanceId)> instance;
  };

  AssetsNode(const NodeContext& context, Parts parts);
  AssetsNode(const AssetsNode&) = delete;
  AssetsNode& operator=(const AssetsNode&) = delete;

  /// Somebody asks, be it by way of a detection; what the answer says of it besides.
  void on_request(const AssetRequest& request, const std::string& remark = "");
  /// Whether this injection was asked before, wherever it was to go; it is then answered as that one.
  [[nodiscard]] bool ask_again(const AssetRequest& request);
  [[nodiscard]] const std::map<std::string, Asset>& assets() const { return assets_; }
  /// Whether all is known that merge has said it holds.
  [[nodiscard]] bool is_up_to_date() const { return heard_revision_ >= 0 && known_revision_ >= heard_revision_; }

 private:
  void put(const AssetRequest& request, std::uint64_t content);
  void take_out(const AssetRequest& request);
  [[nodiscard]] Result<Labels::Injected> meant(const AssetRequest& request) const;
  [[nodiscard]] Result<LabelCorrection::Claim> claim_of(const AssetRequest& request) const;
  [[nodiscard]] Result<LabelCorrection::Claim> claim_of(LabelRequest label, Injection injection) const;
  void on_answer(const Answer& answer);
  void on_history(const HistoryPart& part);
  void ask_history();
  void take_back(const Labels::Waiting& refused, const Answer& why);
  void move_back(const std::string& edit_id, const Answer& why);
  void answer_askers();
  void send_waiting();
  void list();

  NodeContext context_;
  Parts parts_;
  Replies replies_;
  GltfStore gltf_;
  ListSender<Asset> list_;
  std::map<std::string, Asset> assets_;
  std::map<std::string, std::string> asked_;    ///< requests whose askers wait for an answer; the remark in it
  std::map<std::string, std::string> removed_;  ///< the edits that requests took out
  std::int64_t known_revision_ = 0;             ///< of merge's history
  std::int64_t heard_revision_ = -1;            ///< of merge's history, by its status
  std::int64_t asked_revision_ = -1;            ///< what was heard when it was asked last: the answer reaches as far
  bool has_news_ = false;                       ///< merge has answered somebody since it was asked last
  std::string question_;                        ///< what the ids of our questions begin with
  std::int64_t questions_ = 0;
  std::string history_id_;  ///< of the question that is open; empty: none
  std::map<std::int32_t, HistoryPart> history_;
};

}  // namespace concord
