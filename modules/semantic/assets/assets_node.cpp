#include "semantic/assets/assets_node.hpp"

#include <algorithm>
#include <utility>

#include "bus/messages_label.hpp"
#include "core/voxel_boxes.hpp"

namespace concord {
namespace {

const std::string kRequests = "in/asset";
constexpr std::int64_t kPeriod = 1'000'000;
constexpr std::size_t kSentAtOnce = 16;
constexpr const char* kNotKnown = "semantic has just begun and does not know all edits yet; ask again";

std::uint64_t content_without_time(AssetRequest request) {
  request.utime = 0;
  return content_of(encode(request));
}

}  // namespace

AssetsNode::AssetsNode(const NodeContext& context, std::launch how, Parts parts)
    : context_(context),
      parts_(std::move(parts)),
      replies_(context),
      refusals_(context.bus),
      layouts_(context.bus, how),
      folder_(context, how) {
  Bus& bus = context_.bus;
  listen<AssetRequest>(bus, context_.counters, context_.process, kRequests,
                       [this](const std::string&, const AssetRequest& request) {
                         if (request.op == AssetRequest::Op::kDelete) return take_out(request);
                         put(request, content_without_time(request));
                       });
  listen<Answer>(bus, context_.counters, context_.process, kAnswers,
                 [this](const std::string&, const Answer& answer) { on_answer(answer); });
  bus.every(kPeriod, [this] {
    std::erase_if(sent_, [now = context_.bus.now()](const auto& entry) { return now - entry.second >= 2 * kPeriod; });
    send_waiting();
  });
}

const Injections& AssetsNode::injections() const {
  if (!injections_ || injected_revision_ != parts_.labels.injected_revision()) {
    injections_.emplace(parts_.labels);
    injected_revision_ = parts_.labels.injected_revision();
  }
  return *injections_;
}

void AssetsNode::put(const AssetRequest& request, std::uint64_t content, std::optional<Fitting> fitting) {
  if (ask_again(request.id, content) || refusals_.repeat(request.id, context_.process, content, request.utime)) return;
  if (!parts_.history.is_up_to_date()) return replies_.deny(kRequests, request.id, {Code::kBusy, kNotKnown});
  if (const auto fine = check_free(edit_of_asset(request.id)); !fine) {
    return refuse_request(request.id, fine.error(), content, request.utime);
  }
  auto model = model_of(request, fitting);
  if (!model) return refuse_request(request.id, model.error(), content, request.utime);
  if (!layouts_.has_room()) {
    return replies_.deny(kRequests, request.id, {Code::kBusy, "other models are being laid out; ask again"});
  }
  laid_out_[request.id] = content;
  layouts_.add(
      [model = std::move(*model), resolution = context_.site.resolution] {
        return lay_model(model, resolution).map([](const LaidModel& laid) { return to_bytes(laid); });
      },
      [this, request, content, fitting = std::move(fitting)](const Result<Bytes>& reply) {
        finish(request, content, fitting, reply);
      });
}

/// What merge has already would be taken for the edit that is to be sent, and nothing be put in.
Result<void> AssetsNode::check_free(const std::string& edit_id) const {
  if (!parts_.labels.knows_edit(edit_id)) return {};
  return refuse(Code::kExists, "an edit in the map is called " + edit_id + "; ask with another id");
}

void AssetsNode::refuse_request(const std::string& id, const Error& error, std::uint64_t content, std::int64_t asked) {
  refusals_.give(replies_.denied(kRequests, id, error), content, asked);
}

/// How it lies is known: from here on it is one step, and what was asked of a moved model is looked at again.
void AssetsNode::finish(AssetRequest request, std::uint64_t content, const std::optional<Fitting>& fitting,
                        const Result<Bytes>& reply) {
  laid_out_.erase(request.id);
  const auto laid = reply.and_then([](const Bytes& bytes) { return laid_model_from_bytes(bytes); });
  if (!laid) return refuse_request(request.id, laid.error(), content, request.utime);
  std::string remark;
  if (fitting) {
    const auto judged = fitting->judge(laid->fit);
    if (!judged) return;
    remark = *judged;
    request.T_map_asset = laid->fit.T_map_model;
  }
  auto claim = claim_of(request, *laid);
  if (!claim) return refuse_request(request.id, claim.error(), content, request.utime);
  if (const auto done = parts_.commit(request.id, request.author, content, std::move(*claim)); !done) {
    return refuse_request(request.id, done.error(), content, request.utime);
  }
  asked_[request.id] = remark;
  send_waiting();
}

bool AssetsNode::ask_again(const std::string& id, std::uint64_t content) {
  const Labels::Made* before = parts_.labels.find(id);
  const auto being_laid_out = laid_out_.find(id);
  const bool is_being_laid_out = before == nullptr && being_laid_out != laid_out_.end();
  if (before == nullptr && !is_being_laid_out) return false;
  if ((before != nullptr ? before->content : being_laid_out->second) != content) {
    replies_.deny(kRequests, id, {Code::kExists, "another request had this id; ids must be unique"});
  } else if (is_being_laid_out) {
    answer(context_.bus, {id, context_.process, false, name(Code::kBusy),
                          "the model is being laid out; ask again with this id in a second", 0, 0});
  } else if (injections().by_edit(edit_of_asset(id)) == nullptr) {
    replies_.deny(kRequests, id, {Code::kConflict, "it was refused before; ask with another id"});
  } else {
    asked_.try_emplace(id);
    send_waiting();
    answer_askers();
  }
  return true;
}

bool AssetsNode::is_under_way(const std::string& request_id) const {
  return laid_out_.contains(request_id) || parts_.labels.waiting_for(edit_of_asset(request_id)).has_value();
}

/// Merge answers to our undo, and we to who asked.
void AssetsNode::take_out(const AssetRequest& request) {
  const auto edit = edit_to_take_out(request);
  if (!edit) return replies_.deny(kRequests, request.id, edit.error());
  UndoRequest undo = removal(*edit, request.id, request.author);
  undo.utime = request.utime;
  context_.bus.publish("in/undo", encode(undo));
}

/// Asked again, it is the one that it was: by then the model may be back, elsewhere. Kept before merge hears of it.
Result<std::string> AssetsNode::edit_to_take_out(const AssetRequest& request) {
  const std::uint64_t content = content_without_time(request);
  const auto is_repeat = parts_.store.was_asked(request.id, content);
  if (!is_repeat) return tl::unexpected(is_repeat.error());
  if (const auto before = removed_.find(request.id); before != removed_.end()) {
    if (*is_repeat) return before->second;
    return refuse(Code::kExists, "another request had this id; ids must be unique");
  }
  auto there = meant(request);
  if (!there) return tl::unexpected(there.error());
  const auto kept = *is_repeat ? Result<void>() : parts_.store.put_deletion(request.id, content);
  if (!kept) return tl::unexpected(kept.error());
  return std::move(there->edit_id);
}

/// What is to be moved or taken out, where it is now.
Result<Labels::Injected> AssetsNode::meant(const AssetRequest& request) const {
  const Labels::Injected* found = nullptr;
  for (const auto& [injection, there] : injections().placed()) {
    const bool is_meant =
        request.of.empty() ? parts_.labels.owner_of(there.request_id) == request.instance : injection == request.of;
    if (is_meant) found = &there;
  }
  // After a restart it is merge that knows what is in the map.
  if (found == nullptr && !parts_.history.is_up_to_date()) {
    return refuse(Code::kBusy, kNotKnown);
  }
  if (found != nullptr && !injections().is_settled(found->edit_id)) {
    return refuse(Code::kBusy, "it is on its way from one place to another; ask again in a second");
  }
  if (found != nullptr) return *found;
  if (!request.of.empty()) return refuse(Code::kNotFound, "nothing that " + request.of + " injected is in the map");
  return refuse(Code::kNotFound, "no asset in the map is instance " + std::to_string(request.instance.instance) +
                                     " of class " + std::to_string(request.instance.label));
}

Result<const Asset*> AssetsNode::asset_of(const AssetRequest& request) const {
  std::string name = request.asset;
  if (request.op == AssetRequest::Op::kMove) {
    const auto there = meant(request);
    if (!there) return tl::unexpected(there.error());
    name = there->what.asset;
  }
  const auto it = assets().find(name);
  if (it == assets().end()) return refuse(Code::kNotFound, "no asset " + name + "; see: concord asset list");
  return &it->second;
}

Result<ModelToLay> AssetsNode::model_of(const AssetRequest& request, const std::optional<Fitting>& fitting) const {
  const auto asset = asset_of(request);
  if (!asset) return tl::unexpected(asset.error());
  ModelToLay model{context_.site.state / "assets" / (*asset)->file, (*asset)->unit, request.T_map_asset};
  if (!fitting) return model;
  model.surface = fitting->surface;
  if (request.op == AssetRequest::Op::kMove) model.T_map_present = meant(request)->what.T_map_asset;
  return model;
}

Result<LabelCorrection::Claim> AssetsNode::claim_of(const AssetRequest& request, const LaidModel& laid) const {
  const auto asset = asset_of(request);
  if (!asset) return tl::unexpected(asset.error());
  LabelRequest label;
  label.name = (*asset)->class_name;
  Injection injection{(*asset)->name, request.T_map_asset, ""};
  if (request.op == AssetRequest::Op::kMove) {
    const Labels::Injected there = *meant(request);
    const InstanceId of = parts_.labels.owner_of(there.request_id).value_or(there.of);
    label.name = parts_.labels.classes().at(of.label).name;
    label.of.instance = of.instance;
    injection.replaces = there.edit_id;
  }
  if (const auto fine = check_free(edit_of_asset(request.id)); !fine) return tl::unexpected(fine.error());
  const std::vector<VoxelIndex> voxels = laid.voxels.voxels();
  if (const auto fits = voxel_list(voxels, context_.site.resolution); !fits) return tl::unexpected(fits.error());
  auto what = parts_.labels.check(label, voxels);
  if (!what) return tl::unexpected(what.error());
  auto claim = std::get<LabelCorrection::Claim>(std::move(*what));
  claim.injection = std::move(injection);
  claim.edit_id = edit_of_asset(request.id);
  return claim;
}

/// Merge's word on one of our edits, or on the other half of a move.
void AssetsNode::on_answer(const Answer& answer) {
  if (answer.process != "merge") return;
  if (const std::string asked = asked_removal(answer.id); !asked.empty()) {
    concord::answer(context_.bus,
                    {asked, context_.process, answer.ok, answer.code, answer.message, answer.revision, answer.count});
  }
  if (answer.ok || answer.code == name(Code::kBusy)) return;
  if (const auto ours = parts_.labels.waiting_for(answer.id)) take_back(*ours, answer);
  if (auto back = reversal(answer.id)) reverse(std::move(*back), answer);
}

/// The other half of what a person asked for may not be: neither half is, and who waits hears so.
void AssetsNode::reverse(UndoRequest back, const Answer& why) {
  const Labels::Injected* one = injections().by_edit(back.edit_id);
  if (one == nullptr) return;
  if (asked_.erase(one->request_id) > 0) {
    answer(context_.bus, {one->request_id, context_.process, false, why.code, why.message, 0, 0});
  }
  context_.counters.refused("asset_undo", {Code::kConflict, one->edit_id + " stays as it was: " + why.message});
  back.author = one->author;
  back.utime = context_.bus.now();
  context_.bus.publish("in/undo", encode(back));
}

/// An injection that merge refused is one that nobody made, but its numbers are spent.
void AssetsNode::take_back(const Labels::Waiting& refused, const Answer& why) {
  const auto done =
      parts_.commit(refused.edit_id + ".refused", refused.author, 0, LabelCorrection::Undo{refused.request_id, false});
  if (!done) return context_.counters.refused("asset_undo", done.error());
  if (asked_.erase(refused.request_id) == 0) return;
  answer(context_.bus, {refused.request_id, context_.process, false, why.code, why.message, 0, 0});
}

/// Claims may come later than what merge says of their edits, with a loaded map: all is kept that could be one's.
void AssetsNode::on_operation(const Operation& operation, BrickSet& touched) {
  if (const std::string asked = asked_removal(operation.id); !asked.empty()) removed_[asked] = operation.subject;
  const bool takes_back = operation.kind == Operation::Kind::kUndo,
             brings_back = operation.kind == Operation::Kind::kRedo;
  const std::string& edit = takes_back || brings_back ? operation.subject : operation.id;
  if (!edit.starts_with(edit_of_asset(""))) return;
  parts_.labels.set_edit(edit, {!takes_back, operation.revision, is_ours(operation.id)}, touched);
  injections_.reset();
}

void AssetsNode::answer_askers() {
  if (asked_.empty() || !parts_.history.is_up_to_date()) return;
  for (auto asker = asked_.begin(); asker != asked_.end();) {
    const Labels::Injected* one = injections().by_edit(edit_of_asset(asker->first));
    if (one == nullptr || !one->edit || !injections().is_settled(one->edit_id)) {
      ++asker;
      continue;
    }
    LabelInstance instance = parts_.instance(one->of);
    instance.asset = one->what.asset;
    instance.T_map_asset = one->what.T_map_asset;
    const char* done = one->what.replaces.empty() ? " is put in" : " is moved";
    context_.bus.publish("out/label_list", encode(LabelList{one->request_id, 0, 1, {instance}}, context_.bus.now()));
    replies_.grant(
        one->request_id, parts_.labels.find(one->request_id)->revision, one->count,
        class_of(*one) + " " + std::to_string(one->of.instance) + done + asker->second + "; edit " + one->edit_id);
    asker = asked_.erase(asker);
  }
}

/// Not before all that merge has is known: what it took long ago must not be asked again and again. And each but once a
/// second, whatever merge answers: a refusal would be asked for at the speed of the bus.
void AssetsNode::send_waiting() {
  if (!parts_.history.is_up_to_date()) return;
  for (UndoRequest& undo : injections().due()) {
    if (!may_send(undo.id)) continue;
    undo.utime = context_.bus.now();
    context_.bus.publish("in/undo", encode(undo));
  }
  for (const Labels::Waiting& waiting : parts_.labels.waiting(kSentAtOnce)) {
    if (!may_send(waiting.edit_id)) continue;
    EditRequest edit;
    edit.id = waiting.edit_id;
    edit.author = waiting.author;
    edit.shape = VoxelList{context_.site.resolution, to_boxes(waiting.voxels)};
    edit.utime = waiting.utime;  // sent again, it is the same to the byte
    context_.bus.publish("in/edit", encode(edit));
  }
}

bool AssetsNode::may_send(const std::string& id) {
  const std::int64_t now = context_.bus.now();
  const auto [it, is_first] = sent_.try_emplace(id, now);
  if (is_first) return true;
  if (now - it->second < kPeriod) return false;
  it->second = now;
  return true;
}

}  // namespace concord
