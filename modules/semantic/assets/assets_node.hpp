#pragma once

#include <functional>
#include <future>
#include <map>
#include <optional>
#include <string>

#include "bus/messages_asset.hpp"
#include "bus/process.hpp"
#include "bus/recent_answers.hpp"
#include "bus/replies.hpp"
#include "semantic/assets/asset_folder_node.hpp"
#include "semantic/assets/injections.hpp"
#include "semantic/assets/lay_model.hpp"
#include "semantic/edit_history_node.hpp"
#include "semantic/labels/labels.hpp"
#include "semantic/semantic_store.hpp"
#include "semantic/work_queue.hpp"

namespace concord {

/// Puts models into the map. Where a model lies is worked out beside the bus; who asks again meanwhile is told kBusy.
/// The intent is stored first: a label of the model's voxels that holds while the edit asset-ID does. Then the edit is
/// sent to merge, again each second until merge has answered, also after a restart of either. Who undoes that edit
/// undoes the injection, label and all.
///
/// One that is moved is an edit in its new place and an undo of the one in its old (injections.hpp): the second is
/// asked for when merge has the first, each second until it is so; refused, the first is undone.
class AssetsNode {
 public:
  struct Parts {
    Labels& labels;
    const EditHistoryNode& history;
    /// Stores and applies a label correction. Refused: kIo.
    std::function<Result<void>(const std::string& id, const std::string& author, std::uint64_t content, Labels::What)>
        commit;
    SemanticStore& store;
    /// How an instance shows in the map.
    std::function<LabelInstance(InstanceId)> instance;
  };

  /// @param how deferred: models are laid out while the bus waits, so that on log time it takes none.
  AssetsNode(const NodeContext& context, std::launch how, Parts parts);
  AssetsNode(const AssetsNode&) = delete;
  AssetsNode& operator=(const AssetsNode&) = delete;

  /// How a model comes to lie that is put where something was seen.
  struct Fitting {
    /// See ModelToLay; asked for in another process.
    std::function<BrickMasks(const BrickMasks& present)> surface;
    /// What the answer says of the fit besides; nothing: it is not to be put there, and nobody waits for an answer.
    std::function<std::optional<std::string>(const ObjectFit&)> judge;
  };
  /// @param request kInject or kMove. @param content tells requests of one id apart.
  void put(const AssetRequest& request, std::uint64_t content, std::optional<Fitting> fitting = {});
  /// Whether this was asked before; it is then answered as that was, or refused (kExists) if it was something else.
  [[nodiscard]] bool ask_again(const std::string& id, std::uint64_t content);
  /// Whether it is asked for and neither in the map nor refused yet.
  [[nodiscard]] bool is_under_way(const std::string& request_id) const;

  /// Merge did something; all was told that it did until now.
  void on_operation(const Operation& operation, BrickSet& touched);
  void on_told() {
    send_waiting();
    answer_askers();
  }

  [[nodiscard]] const std::map<std::string, Asset>& assets() const { return folder_.assets(); }
  [[nodiscard]] const Injections& injections() const;
  /// What it is called now.
  [[nodiscard]] const std::string& class_of(const Labels::Injected& injected) const {
    return parts_.labels.classes().at(injected.of.label).name;
  }

 private:
  void take_out(const AssetRequest& request);
  [[nodiscard]] Result<std::string> edit_to_take_out(const AssetRequest& request);
  [[nodiscard]] Result<void> check_free(const std::string& edit_id) const;
  [[nodiscard]] Result<Labels::Injected> meant(const AssetRequest& request) const;
  [[nodiscard]] Result<const Asset*> asset_of(const AssetRequest& request) const;
  [[nodiscard]] Result<ModelToLay> model_of(const AssetRequest& request, const std::optional<Fitting>& fitting) const;
  void finish(AssetRequest request, std::uint64_t content, const std::optional<Fitting>& fitting,
              const Result<Bytes>& reply);
  [[nodiscard]] Result<LabelCorrection::Claim> claim_of(const AssetRequest& request, const LaidModel& laid) const;
  void refuse_request(const std::string& id, const Error& error, std::uint64_t content, std::int64_t asked);
  void on_answer(const Answer& answer);
  void take_back(const Labels::Waiting& refused, const Answer& why);
  void reverse(UndoRequest back, const Answer& why);
  void answer_askers();
  void send_waiting();
  [[nodiscard]] bool may_send(const std::string& id);

  NodeContext context_;
  Parts parts_;
  Replies replies_;
  RecentAnswers refusals_;
  WorkQueue layouts_;
  AssetFolderNode folder_;
  std::map<std::string, std::uint64_t> laid_out_;  ///< requests whose models are, and their content
  std::map<std::string, std::string> asked_;       ///< requests whose askers wait for an answer; the remark in it
  std::map<std::string, std::string> removed_;     ///< the edits that requests took out
  std::map<std::string, std::int64_t> sent_;       ///< when what was asked of merge was asked last
  mutable std::optional<Injections> injections_;   ///< as of the revisions below
  mutable std::int64_t injected_revision_ = -1;
};

}  // namespace concord
