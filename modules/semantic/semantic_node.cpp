#include "semantic/semantic_node.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <utility>

#include <spdlog/spdlog.h>

#include "bus/recent_answers.hpp"
#include "semantic/labels/anchor.hpp"

namespace concord {
namespace {

const std::string kRequests = "in/label";
const std::string kQueries = "in/label_query";
constexpr std::int64_t kTick = 50'000;         ///< changes of the map are gathered for so long, microseconds
constexpr std::int64_t kLaidAtOnce = 20'000;   ///< voxels of labels whose agent was realigned, in a tick
constexpr std::int64_t kSlotPeriod = 200'000;  ///< the list of slots is told at most so often
constexpr const char* kNotWhole = "semantic has just begun and does not know the whole map yet; ask again in a second";
constexpr std::int64_t kCountPeriod = 1'000'000;

std::uint64_t content_without_time(LabelRequest request) {
  request.utime = 0;
  return content_of(encode(request));
}

std::string words(const LabelInstance& instance) {
  const std::string number = instance.of.instance != 0 ? " " + std::to_string(instance.of.instance) : "";
  return instance.name + number + " (class " + std::to_string(instance.of.label) + ")";
}

}  // namespace

SemanticNode::SemanticNode(const NodeContext& context, std::launch how)
    : context_(context),
      replies_(context),
      store_(context.site.state / "semantic.db", context.site.resolution),
      layers_(context),
      labels_(context.site.resolution),
      view_(labels_, map_, context.site.resolution),
      selection_(map_, context.site.resolution),
      map_receiver_(context.bus, context.counters, {.stream = "out/map", .resolution = context.site.resolution},
                    {.on_frame =
                         [this](const std::string&) {
                           for (const BrickIndex index : map_.sorted_bricks()) dirty_.insert(index);
                           map_.clear();
                         },
                     .on_brick =
                         [this](BrickIndex index, Brick brick) {
                           map_.set(index, std::move(brick));
                           dirty_.insert(index);
                         },
                     .on_end =
                         [this] {
                           for (const BrickIndex index : map_.sorted_bricks()) dirty_.insert(index);
                           map_.clear();
                         }}),
      label_stream_(context.bus, context.counters,
                    {.stream = "out/labels",
                     .resolution = context.site.resolution,
                     .bytes_per_second = context.site.stream.bytes_per_second,
                     .boot_id = context.boot_id},
                    view_.shown()),
      slot_list_(context.bus, context.counters, "out/label_slots", context.site.stream.bytes_per_second),
      queue_(context.bus, context.site.stream.bytes_per_second),
      history_node_(context, {.on_operation =
                                  [this](const Operation& operation) { assets_node_.on_operation(operation, edited_); },
                              .on_told =
                                  [this] {
                                    refresh(std::exchange(edited_, {}));
                                    assets_node_.on_told();
                                  }}),
      assets_node_(context, how,
                   {labels_, history_node_,
                    [this](const std::string& id, const std::string& author, std::uint64_t content, Labels::What what) {
                      return commit(id, author, content, std::move(what));
                    },
                    store_, [this](InstanceId of) { return view_.instance(of); }}),
      detections_node_(context, {map_, labels_, layers_, assets_node_, store_, selection_}),
      files_node_(context, {labels_, [this](const auto& visit) { return store_.for_each(visit); },
                            [this](const std::vector<LabelCorrection>& all) { return commit(all); }}),
      margins_node_(context, labels_, view_, [this] { return is_whole(); }) {
  restore();
  listen_to_the_map();
  Bus& bus = context_.bus;
  listen<LabelRequest>(bus, context_.counters, context_.process, kRequests,
                       [this](const std::string&, const LabelRequest& request) { on_request(request); });
  listen<LabelQuery>(bus, context_.counters, context_.process, kQueries,
                     [this](const std::string&, const LabelQuery& query) { on_query(query); });
  bus.every(kTick, [this] {
    (void)labels_.lay_some(kLaidAtOnce, dirty_);  // the rest at the next tick
    refresh(dirty_);
    dirty_.clear();
    if (begun_ || !map_receiver_.synced()) return;
    begun_ = true;  // what shows is whole: before, a restart would look like labels that went
    label_stream_.begin("map");
  });
  bus.every(kSlotPeriod, [this] { tell_slots(); });
  bus.every(kCountPeriod, [this] {
    context_.counters.set("label_revision", labels_.revision());
    context_.counters.set("classes", static_cast<std::int64_t>(labels_.classes().size()));
    context_.counters.set("instances", static_cast<std::int64_t>(view_.slot_count()));
    context_.counters.set("labelled_voxels", static_cast<std::int64_t>(view_.shown().known_count()));
  });
}

void SemanticNode::listen_to_the_map() {
  Bus& bus = context_.bus;
  listen<BrickPacket>(bus, context_.counters, context_.process, "out/map/bricks",
                      [this](const std::string&, const BrickPacket& packet) { map_receiver_.on_packet(packet); });
  listen<BrickDigest>(bus, context_.counters, context_.process, "out/map/digest",
                      [this](const std::string&, const BrickDigest& digest) { map_receiver_.on_digest(digest); });
  listen<AgentList>(bus, context_.counters, context_.process, "out/agents",
                    [this](const std::string&, const AgentList& list) { on_agents(list); });
}

/// A label goes along with the agent that it lies on. Where that was last is kept: it may be gone when we start again.
void SemanticNode::on_agents(const AgentList& list) {
  selection_.follow(list.agents);
  for (const AgentState& agent : list.agents) {
    const LabelAnchor now{agent.id, agent.frame_id, agent.T_map_agent};
    if (!agent.aligned || !labels_.is_news(now)) continue;
    if (const auto kept = store_.put(now); !kept) {
      context_.counters.refused("out/agents", kept.error());
      continue;
    }
    labels_.place(now);
  }
}

void SemanticNode::restore() {
  BrickSet touched;
  const auto done = store_.for_each([&](const LabelCorrection& correction) -> Result<void> {
    labels_.apply(correction, touched);
    return {};
  });
  if (!done) throw std::runtime_error(done.error().message);
  const auto placements = store_.placements();
  if (!placements) throw std::runtime_error(placements.error().message);
  for (const LabelAnchor& placed : *placements) labels_.place(placed);
  while (labels_.lay_some(kLaidAtOnce, touched)) {
  }
  spdlog::info("restored labels up to revision {}", labels_.revision());
}

/// Checked, stored, applied, answered: in this order, so that nobody sees what a power cut could take back.
void SemanticNode::on_request(const LabelRequest& request) {
  const std::uint64_t content = content_without_time(request);
  if (repeat(request, content)) return;
  if (request.op == LabelRequest::Op::kDelete) return on_delete(request, content);
  if (const auto is_free = store_.was_asked(request.id, content); !is_free) {  // a deletion may have this id
    return replies_.deny(kRequests, request.id, is_free.error());
  }
  auto what = check(request);
  if (!what) return replies_.deny(kRequests, request.id, what.error());
  if (const auto done = commit(request.id, request.author, content, std::move(*what)); !done) {
    return replies_.deny(kRequests, request.id, done.error());
  }
  grant(request.id, *labels_.find(request.id), "");
}

Result<void> SemanticNode::commit(const std::string& id, const std::string& author, std::uint64_t content,
                                  Labels::What what) {
  std::vector<LabelCorrection> one;
  one.push_back({labels_.revision() + 1, id, author, context_.bus.now(), content, std::move(what)});
  return commit(one);
}

/// All of them or, where the disk says no, none.
Result<void> SemanticNode::commit(const std::vector<LabelCorrection>& corrections) {
  if (const auto stored = store_.put(corrections); !stored) return stored;
  BrickSet touched;
  for (const LabelCorrection& correction : corrections) labels_.apply(correction, touched);
  refresh(touched);
  label_stream_.send_now();
  margins_node_.touch_names();
  has_new_slots_ = true;
  return {};
}

bool SemanticNode::repeat(const LabelRequest& request, std::uint64_t content) {
  const Labels::Made* before = labels_.find(request.id);
  if (before == nullptr) return false;
  if (before->content == content) {
    grant(request.id, *before, " since it was asked before");
  } else {
    replies_.deny(kRequests, request.id, {Code::kExists, "another request had this id; ids must be unique"});
  }
  return true;
}

void SemanticNode::grant(const std::string& id, const Labels::Made& made, const std::string& message) {
  std::string what = "done";
  if (made.of.label != 0) {
    const LabelInstance instance = made.of.instance != 0
                                       ? view_.instance(made.of)
                                       : LabelInstance{made.of, labels_.classes().at(made.of.label).name, 0, {}, {}};
    context_.bus.publish("out/label_list", encode(LabelList{id, 0, 1, {instance}}, context_.bus.now()));
    what = words(instance);
  }
  replies_.grant(id, made.revision, std::max<std::int64_t>(made.count, 1), what + message);
}

Result<Labels::What> SemanticNode::check(const LabelRequest& request) {
  std::vector<VoxelIndex> voxels;
  const bool is_touch = request.op == LabelRequest::Op::kTouch;
  if (is_touch || request.op == LabelRequest::Op::kLabel || request.op == LabelRequest::Op::kRestore) {
    if (!map_receiver_.synced()) return refuse(Code::kBusy, "the map has not arrived whole; ask again in a second");
    auto taken =
        is_touch ? selection_.touched(request.shape, request.frame) : selection_.occupied(request.shape, request.frame);
    if (!taken) return tl::unexpected(taken.error());
    voxels = std::move(*taken);
  }
  auto what = labels_.check(request, voxels);
  if (!what) return what;
  if (auto* claim = std::get_if<LabelCorrection::Claim>(&*what)) {
    if (!layers_.settled()) return refuse(Code::kBusy, "the submaps have not all been heard; ask again in a second");
    claim->anchor = anchor_of(claim->voxels, layers_.now(), context_.site.resolution);
  }
  return what;
}

/// Whether all that shows did so at some time: after a start, labels of models are there once merge has said which of
/// its edits hold. What is answered before would leave some out.
bool SemanticNode::is_whole() {
  is_whole_ = is_whole_ || (begun_ && (labels_.injected().empty() || history_node_.is_up_to_date()));
  return is_whole_;
}

/// One edit, whose answer is merge's: its id is the request's, so who asked hears it.
void SemanticNode::on_delete(const LabelRequest& request, std::uint64_t content) {
  if (!labels_.classes().contains(request.of.label)) {
    return replies_.deny(kRequests, request.id,
                         {Code::kNotFound, "no class " + std::to_string(request.of.label) + "; see: concord labels"});
  }
  if (!is_whole()) return replies_.deny(kRequests, request.id, {Code::kBusy, kNotWhole});
  if (const auto done = send_deletion(request, content); !done) replies_.deny(kRequests, request.id, done.error());
}

Result<void> SemanticNode::send_deletion(const LabelRequest& request, std::uint64_t content) {
  const auto is_repeat = store_.was_asked(request.id, content);
  if (!is_repeat) return tl::unexpected(is_repeat.error());
  if (const Operation* before = history_node_.find_deletion(request.id); before != nullptr) {
    if (!*is_repeat) return refuse(Code::kExists, "an edit in the map has this id; ids must be unique");
    replies_.grant(request.id, before->revision, before->count, "deleted since it was asked before");
    return {};
  }
  const auto edit = deletion_of(request);
  if (!edit) return tl::unexpected(edit.error());
  // Kept first: whoever asks again after a kill must mean the same.
  if (const auto kept = *is_repeat ? Result<void>() : store_.put_deletion(request.id, content); !kept) return kept;
  context_.bus.publish("in/edit", encode(*edit));
  return {};
}

Result<EditRequest> SemanticNode::deletion_of(const LabelRequest& request) const {
  const std::vector<VoxelIndex> voxels = view_.voxels_of(request.of);
  if (voxels.empty()) return refuse(Code::kEmpty, "nothing of it shows in the map");
  if (static_cast<std::int64_t>(voxels.size()) > kMaxEditVoxels) {
    return refuse(Code::kTooLarge, "it has more voxels than one edit; delete its instances one by one");
  }
  auto list = voxel_list(voxels, context_.site.resolution);
  if (!list) return tl::unexpected(list.error());
  EditRequest edit;
  edit.id = request.id;
  edit.author = request.author;
  edit.op = EditRequest::Op::kDelete;
  edit.shape = std::move(*list);
  edit.utime = context_.bus.now();
  return edit;
}

void SemanticNode::on_query(const LabelQuery& query) {
  if (queue_.waits(query.id)) return;
  if (!is_whole()) return replies_.deny(kQueries, query.id, {Code::kBusy, kNotWhole});
  auto found = view_.answer(query);
  if (!found) return replies_.deny(kQueries, query.id, found.error());
  const auto count = static_cast<std::int64_t>(found->size());
  const auto parts = in_parts({query.id, 0, 1, std::move(*found)});
  if (!queue_.has_room(parts.size() + 1)) {
    return replies_.deny(kQueries, query.id, {Code::kBusy, "earlier lists are still being told; ask again"});
  }
  for (const LabelList& part : parts) queue_.push(query.id, "out/label_list", encode(part, context_.bus.now()));
  queue_.push(query.id, kAnswers,
              encode(replies_.granted(query.id, labels_.revision(), count, "told"), context_.bus.now()));
  queue_.send_now();
}

void SemanticNode::refresh(const BrickSet& touched) {
  const std::size_t slots = view_.slot_count();
  for (const auto& [tile, bricks] : touched.sorted()) {
    for (std::uint64_t bits = bricks; bits != 0; bits &= bits - 1) {
      const BrickIndex index = brick_at(tile, std::countr_zero(bits));
      if (!view_.refresh(index)) continue;
      margins_node_.touch(index);
      if (begun_) label_stream_.touch(index);
    }
  }
  has_new_slots_ = has_new_slots_ || view_.slot_count() != slots;
}

void SemanticNode::tell_slots() {
  if (!has_new_slots_ || !begun_) return;
  slot_list_.set(view_.slots());
  has_new_slots_ = false;
}

}  // namespace concord
