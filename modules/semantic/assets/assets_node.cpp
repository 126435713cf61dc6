#include "semantic/assets/assets_node.hpp"

#include <algorithm>

#include "bus/messages_label.hpp"
#include "bus/recent_answers.hpp"
#include "core/voxel_boxes.hpp"
#include "semantic/assets/asset_folder.hpp"
#include "semantic/assets/injections.hpp"
#include "semantic/models/model_file.hpp"
#include "semantic/models/solid_voxels.hpp"

namespace concord {
namespace {

const std::string kRequests = "in/asset";
constexpr std::int64_t kPeriod = 1'000'000;
constexpr std::size_t kMostOperations = 10'000;  ///< in one answer of merge's history
constexpr std::size_t kSentAtOnce = 16;

std::uint64_t content_without_time(AssetRequest request) {
  request.utime = 0;
  return content_of(encode(request));
}

}  // namespace

AssetsNode::AssetsNode(const NodeContext& context, Parts parts)
    : context_(context),
      parts_(std::move(parts)),
      replies_(context),
      gltf_(context.site.state / "assets"),
      list_(context.bus, context.counters, "out/assets", context.site.stream.bytes_per_second),
      question_("semantic-" + std::to_string(context.boot_id) + "-") {
  Bus& bus = context_.bus;
  listen<AssetRequest>(bus, context_.counters, context_.process, kRequests,
                       [this](const std::string&, const AssetRequest& request) { on_request(request); });
  listen<Answer>(bus, context_.counters, context_.process, kAnswers,
                 [this](const std::string&, const Answer& answer) { on_answer(answer); });
  listen<ProcessStatus>(bus, context_.counters, context_.process, "out/status/merge",
                        [this](const std::string&, const ProcessStatus& status) {
                          const auto it = status.counters.find("edit_revision");
                          if (it != status.counters.end()) heard_revision_ = std::max(heard_revision_, it->second);
                        });
  listen<HistoryPart>(bus, context_.counters, context_.process, "out/history",
                      [this](const std::string&, const HistoryPart& part) { on_history(part); });
  list();
  bus.every(kPeriod, [this] {
    has_news_ = has_news_ || !history_id_.empty();  // what was not answered in a second is asked again
    history_id_.clear();
    ask_history();
    send_waiting();
    if (const auto written = gltf_.write_next(assets_); !written) context_.counters.refused("assets", written.error());
    list();
  });
}

void AssetsNode::list() {
  auto read = read_asset_folder(context_.site.state / "assets");
  if (!read) return context_.counters.refused("assets", read.error());
  assets_ = std::move(*read);
  std::vector<Asset> all;
  for (auto& [name, asset] : assets_) {
    asset.gltf_bytes = gltf_.bytes_of(asset);
    asset.size = gltf_.size_of(asset);
    all.push_back(asset);
  }
  list_.set(all);
}

void AssetsNode::on_request(const AssetRequest& request, const std::string& remark) {
  if (request.op == AssetRequest::Op::kDelete) return take_out(request);
  const std::uint64_t content = content_without_time(request);
  if (const Labels::Made* before = parts_.labels.find(request.id); before != nullptr && before->content != content) {
    return replies_.deny(kRequests, request.id, {Code::kExists, "another request had this id; ids must be unique"});
  }
  if (ask_again(request)) return;
  auto claim = claim_of(request);
  if (!claim) return replies_.deny(kRequests, request.id, claim.error());
  if (const auto done = parts_.commit(request.id, request.author, content, std::move(*claim)); !done) {
    return replies_.deny(kRequests, request.id, done.error());
  }
  asked_[request.id] = remark;
  send_waiting();
}

bool AssetsNode::ask_again(const AssetRequest& request) {
  if (parts_.labels.find(request.id) == nullptr) return false;
  const auto all = parts_.labels.injected();
  if (std::ranges::find(all, request.id, &Labels::Injected::request_id) == all.end()) {
    replies_.deny(kRequests, request.id, {Code::kConflict, "it was refused before; ask with another id"});
    return true;
  }
  asked_.try_emplace(request.id);
  send_waiting();
  answer_askers();
  return true;
}

/// Merge answers to our undo, and we to who asked.
void AssetsNode::take_out(const AssetRequest& request) {
  const auto before = removed_.find(request.id);
  const auto there = meant(request);
  if (before == removed_.end() && !there) return replies_.deny(kRequests, request.id, there.error());
  UndoRequest undo = removal(before != removed_.end() ? before->second : there->edit_id, request.id, request.author);
  undo.utime = request.utime;
  context_.bus.publish("in/undo", encode(undo));
}

/// What is to be moved or taken out, where it is now.
Result<Labels::Injected> AssetsNode::meant(const AssetRequest& request) const {
  for (const auto& [injection, there] : placed(parts_.labels)) {
    const bool is_meant =
        request.of.empty() ? parts_.labels.owner_of(there.request_id) == request.instance : injection == request.of;
    if (is_meant) return there;
  }
  // After a restart it is merge that knows what is in the map.
  if (!is_up_to_date()) {
    return refuse(Code::kBusy, "semantic has just begun and does not know all edits yet; ask again");
  }
  if (!request.of.empty()) return refuse(Code::kNotFound, "nothing that " + request.of + " injected is in the map");
  return refuse(Code::kNotFound, "no asset in the map is instance " + std::to_string(request.instance.instance) +
                                     " of class " + std::to_string(request.instance.label));
}

Result<LabelCorrection::Claim> AssetsNode::claim_of(const AssetRequest& request) const {
  LabelRequest label;
  if (request.op == AssetRequest::Op::kMove) {
    const auto there = meant(request);
    if (!there) return tl::unexpected(there.error());
    const InstanceId of = parts_.labels.owner_of(there->request_id).value_or(there->of);
    label.name = parts_.labels.classes().at(of.label).name;
    label.of.instance = of.instance;
    return claim_of(std::move(label), {there->what.asset, request.T_map_asset, there->edit_id}).map([&](auto claim) {
      claim.edit_id = edit_of_asset(request.id);
      return claim;
    });
  }
  const auto it = assets_.find(request.asset);
  if (it == assets_.end()) return refuse(Code::kNotFound, "no asset " + request.asset + "; see: concord asset list");
  label.name = it->second.class_name;
  return claim_of(std::move(label), {request.asset, request.T_map_asset, ""}).map([&](auto claim) {
    claim.edit_id = edit_of_asset(request.id);
    return claim;
  });
}

Result<LabelCorrection::Claim> AssetsNode::claim_of(LabelRequest label, Injection injection) const {
  const auto it = assets_.find(injection.asset);
  if (it == assets_.end()) return refuse(Code::kNotFound, "no asset " + injection.asset + "; see: concord asset list");
  const Asset& asset = it->second;
  const auto mesh = read_model_file(context_.site.state / "assets" / asset.file);
  if (!mesh) return tl::unexpected(mesh.error());
  const auto voxels = voxelize(*mesh, {injection.T_map_asset, asset.unit}, context_.site.resolution, Fill::kSolid);
  if (!voxels) return tl::unexpected(voxels.error());
  BrickMasks all = voxels->surface;
  all.insert(voxels->interior);
  auto what = parts_.labels.check(label, all.voxels());
  if (!what) return tl::unexpected(what.error());
  auto claim = std::get<LabelCorrection::Claim>(std::move(*what));
  claim.injection = std::move(injection);
  return claim;
}

/// Merge's word on one of our edits, or on what others asked for: either may be news to its history. An answer's
/// revision is none of the history's where a map was saved, so only the status says how far that goes.
void AssetsNode::on_answer(const Answer& answer) {
  if (answer.process != "merge" || answer.id.starts_with(question_)) return;
  has_news_ = true;
  if (const std::string asked = asked_removal(answer.id); !asked.empty()) {
    concord::answer(context_.bus,
                    {asked, context_.process, answer.ok, answer.code, answer.message, answer.revision, answer.count});
  }
  if (!answer.ok && answer.code != name(Code::kBusy)) {
    if (const auto ours = parts_.labels.waiting_for(answer.id)) take_back(*ours, answer);
    if (const std::string moved = moved_by(answer.id); !moved.empty()) move_back(moved, answer);
  }
  ask_history();
}

/// The old place could not be left: who asked hears so, and the new one is. Nobody waits after a restart; then it is
/// tried again until it can.
void AssetsNode::move_back(const std::string& edit_id, const Answer& why) {
  for (const Labels::Injected& one : parts_.labels.injected()) {
    if (one.edit_id != edit_id || asked_.erase(one.request_id) == 0) continue;
    answer(context_.bus, {one.request_id, context_.process, false, why.code, why.message, 0, 0});
    const UndoRequest undo{edit_id + ".refused", one.author, edit_id, false, context_.bus.now()};
    context_.bus.publish("in/undo", encode(undo));
  }
}

/// An injection that merge refused is one that nobody made, but its numbers are spent.
void AssetsNode::take_back(const Labels::Waiting& refused, const Answer& why) {
  const auto done =
      parts_.commit(refused.edit_id + ".refused", refused.author, 0, LabelCorrection::Undo{refused.request_id, false});
  if (!done) return context_.counters.refused("asset_undo", done.error());
  if (asked_.erase(refused.request_id) == 0) return;
  answer(context_.bus, {refused.request_id, context_.process, false, why.code, why.message, 0, 0});
}

void AssetsNode::ask_history() {
  if (!history_id_.empty() || (!has_news_ && heard_revision_ <= known_revision_)) return;
  HistoryRequest request;
  history_id_ = question_ + std::to_string(++questions_);
  has_news_ = false;
  asked_revision_ = heard_revision_;
  history_.clear();
  request.id = history_id_;
  request.after_revision = known_revision_;
  request.most = kMostOperations;
  context_.bus.publish("in/history_request", encode(request, context_.bus.now()));
}

void AssetsNode::on_history(const HistoryPart& part) {
  if (part.id != history_id_) return;
  if (!history_.empty() && history_.begin()->second.parts != part.parts) history_.clear();
  history_[part.part] = part;
  if (static_cast<std::int32_t>(history_.size()) < part.parts) return;
  const auto parts = std::exchange(history_, {});
  history_id_.clear();
  BrickSet touched;
  std::size_t count = 0;
  for (const auto& [number, one] : parts) {
    count += one.operations.size();
    for (const Operation& operation : one.operations) {
      known_revision_ = std::max(known_revision_, operation.revision);
      if (const std::string asked = asked_removal(operation.id); !asked.empty()) removed_[asked] = operation.subject;
      const bool takes_back = operation.kind == Operation::Kind::kUndo,
                 brings_back = operation.kind == Operation::Kind::kRedo;
      const std::string& edit = takes_back || brings_back ? operation.subject : operation.id;
      if (parts_.labels.is_edit_of_claim(edit)) {
        parts_.labels.set_edit(edit, {!takes_back, operation.revision, is_ours(operation.id)}, touched);
      }
    }
  }
  if (count < kMostOperations) {
    known_revision_ = std::max(known_revision_, asked_revision_);
  } else {
    has_news_ = true;
  }
  parts_.refresh(touched);
  send_waiting();
  answer_askers();
  ask_history();
}

void AssetsNode::answer_askers() {
  if (asked_.empty() || !is_up_to_date()) return;
  for (const Labels::Injected& one : parts_.labels.injected()) {
    const auto asker = asked_.find(one.request_id);
    if (asker == asked_.end() || !one.edit || !has_moved(one, parts_.labels)) continue;
    const std::string& class_name = parts_.labels.classes().at(one.of.label).name;
    LabelInstance instance = parts_.instance(one.of);
    instance.asset = one.what.asset;
    context_.bus.publish("out/label_list", encode(LabelList{one.request_id, 0, 1, {instance}}, context_.bus.now()));
    replies_.grant(
        one.request_id, parts_.labels.find(one.request_id)->revision, one.count,
        class_name + " " + std::to_string(one.of.instance) + " is put in" + asker->second + "; edit " + one.edit_id);
    asked_.erase(asker);
  }
}

/// Not before all that merge has is known: what it took long ago must not be asked again and again.
void AssetsNode::send_waiting() {
  if (!is_up_to_date()) return;
  for (UndoRequest& undo : due(parts_.labels)) {
    undo.utime = context_.bus.now();
    context_.bus.publish("in/undo", encode(undo));
  }
  for (const Labels::Waiting& waiting : parts_.labels.waiting(kSentAtOnce)) {
    EditRequest edit;
    edit.id = waiting.edit_id;
    edit.author = waiting.author;
    edit.shape = VoxelList{context_.site.resolution, to_boxes(waiting.voxels)};
    edit.utime = waiting.utime;  // sent again, it is the same to the byte
    context_.bus.publish("in/edit", encode(edit));
  }
}

}  // namespace concord
