#include "bridge/label_copy.hpp"

#include <set>

namespace concord::hmd {
namespace {

constexpr int kEdge = 64;  ///< voxels of a block
constexpr std::int32_t kNothing = -1;

}  // namespace

LabelCopy::LabelCopy(const NodeContext& context, Hub& hub)
    : context_(context),
      hub_(hub),
      slot_list_(context.bus, context.counters, "out/label_slots",
                 [this](const std::vector<LabelSlot>& slots) { take_slots(slots); }),
      receiver_(context.bus, context.counters, {.stream = "out/labels", .resolution = context.site.resolution},
                {.on_frame = [this](const std::string& frame_id) { begin(frame_id); },
                 .on_brick = [this](BrickIndex index, Brick brick) { take(index, std::move(brick)); },
                 .on_end = [this] { begin("ended"); }}) {
  hub_.layers().open(kLabelStream, 1, [this](const BlockIndex& block) { return say(block); }).epoch = "none";
  listen<BrickPacket>(context_.bus, context_.counters, context_.process, "out/labels/bricks",
                      [this](const std::string&, const BrickPacket& packet) { receiver_.on_packet(packet); });
  listen<BrickDigest>(context_.bus, context_.counters, context_.process, "out/labels/digest",
                      [this](const std::string&, const BrickDigest& digest) { receiver_.on_digest(digest); });
}

void LabelCopy::begin(const std::string& frame_id) {
  map_.clear();
  slots_.clear();  // they may mean something else now; the list comes after
  hub_.restart_layer(kLabelStream, std::to_string(context_.boot_id) + "-" + std::to_string(++begun_) + "-" + frame_id);
}

void LabelCopy::take(BrickIndex index, Brick brick) {
  Layers& layers = hub_.layers();
  ShownLayer& layer = *layers.find(kLabelStream);
  const std::int64_t before = layer.revision;
  layers.set(layer, index, brick.known());
  // Another thing may have the very same voxels.
  if (map_.set(index, std::move(brick)) && layer.revision == before) layers.touch(layer, index);
}

/// Voxels may have come before what their slots mean; and a semantic process that was started anew gives the same slots
/// to other things.
void LabelCopy::take_slots(const std::vector<LabelSlot>& slots) {
  const std::map<std::int32_t, InstanceId> before = std::exchange(slots_, {});
  std::set<std::int32_t> news;
  for (const LabelSlot& slot : slots) {
    slots_.insert_or_assign(slot.slot, slot.of);
    const auto was = before.find(slot.slot);
    if (was == before.end() || was->second != slot.of) news.insert(slot.slot);
  }
  for (const auto& [slot, of] : before) {
    if (!slots_.contains(slot)) news.insert(slot);
  }
  if (news.empty()) return;
  Layers& layers = hub_.layers();
  for (const BrickIndex index : map_.sorted_bricks()) {
    bool is_news = false;
    map_.find(index)->for_each([&](int, LogOdds value) {
      is_news = is_news || news.contains(static_cast<std::int32_t>(slot_of_value(value)));
    });
    if (is_news) layers.touch(*layers.find(kLabelStream), index);
  }
}

BlockStore::Said LabelCopy::say(const BlockIndex& block) const {
  LabelContent content;
  content.block = block;
  std::vector<std::int32_t> things(static_cast<std::size_t>(kEdge) * kEdge * kEdge, kNothing);
  std::map<std::int32_t, std::int32_t> numbers;  // of the things in this frame, by slot
  for (int i = 0; i < 512; ++i) {
    const BrickIndex index{block.x * 8 + i % 8, block.y * 8 + i / 8 % 8, block.z * 8 + i / 64};
    const Brick* brick = map_.find(index);
    if (brick == nullptr) continue;
    brick->for_each([&](int local, LogOdds value) {
      const auto slot = slots_.find(slot_of_value(value));
      if (slot == slots_.end()) return;
      const auto [number, is_new] = numbers.try_emplace(slot->first, static_cast<std::int32_t>(content.things.size()));
      if (is_new) content.things.push_back({slot->second.label, slot->second.instance});
      const VoxelIndex v = voxel_at(index, local);
      const int x = v.x - block.x * kEdge, y = v.y - block.y * kEdge, z = v.z - block.z * kEdge;
      things[static_cast<std::size_t>(x + kEdge * (y + kEdge * z))] = number->second;
    });
  }
  std::size_t told = 0;
  for (std::size_t at = 0; at < things.size();) {
    std::size_t end = at + 1;
    while (end < things.size() && things[end] == things[at]) ++end;
    if (things[at] != kNothing) {
      content.runs.push_back({static_cast<std::uint32_t>(at - told), static_cast<std::uint32_t>(end - at),
                              static_cast<std::uint32_t>(things[at])});
      told = end;
    }
    at = end;
  }
  return {FrameKind::kLabels, labels_payload(content), static_cast<std::uint32_t>(content.things.size())};
}

void LabelCopy::publish() {
  hub_.publish_layer(kLabelStream, receiver_.revision(),
                     receiver_.heard() && receiver_.synced() && slot_list_.synced());
}

}  // namespace concord::hmd
