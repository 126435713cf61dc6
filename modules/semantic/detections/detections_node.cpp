#include "semantic/detections/detections_node.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

namespace concord {
namespace {

const std::string kSeen = "in/detection", kDecisions = "in/detection_decision";
constexpr std::int64_t kPeriod = 1'000'000;
constexpr double kLeastScore = 0.5;
constexpr std::int64_t kNumbersAtOnce = 100;
/// What sightings may spend of what all labels may take, and all edits (kMaxPins): the rest is people's.
constexpr std::int64_t kMostMovedVoxels = kMaxLabelVoxelsEver / 4;
constexpr const char* kWasDropped =
    ", which a person dropped: it is proposed again when nobody has seen it for ten minutes";

std::uint64_t content_without_time(DetectionDecision decision) {
  decision.utime = 0;
  return content_of(encode(decision));
}

std::string words(const ObjectFit& fit) {
  char out[160];
  std::snprintf(out, sizeof(out),
                ", %.0f %% of its surface within a voxel of the map's (rms %.3f m), %.2f m and %.0f degrees from where "
                "it was seen",
                100 * fit.matched, fit.rms, fit.shift, fit.turn * 180 / M_PI);
  return out;
}

}  // namespace

DetectionsNode::DetectionsNode(const NodeContext& context, Parts parts)
    : context_(context),
      parts_(std::move(parts)),
      replies_(context),
      answers_(context.bus),
      sightings_([this] { return next_number(); }),
      list_(context.bus, context.counters, "out/things", context.site.stream.bytes_per_second) {
  listen<Detection>(context_.bus, context_.counters, context_.process, kSeen,
                    [this](const std::string&, const Detection& detection) { on_detection(detection); });
  listen<DetectionDecision>(context_.bus, context_.counters, context_.process, kDecisions,
                            [this](const std::string&, const DetectionDecision& decision) { on_decision(decision); });
  context_.bus.every(kPeriod, [this] {
    sightings_.forget_dropped(context_.bus.now());
    follow_injections();
    list_.set(sightings_.list());
    context_.counters.set("things", static_cast<std::int64_t>(sightings_.list().size()));
  });
}

void DetectionsNode::on_detection(const Detection& detection) {
  Detection untimed = detection;
  untimed.utime = 0;
  const std::uint64_t content = content_of(encode(untimed));
  if (answers_.repeat(detection.id, context_.process, content, detection.utime)) return;
  const auto seen = see(detection);
  if (!seen) return answers_.give(replies_.denied(kSeen, detection.id, seen.error()), content, detection.utime);
  if (seen->is_dropped) {
    return answers_.give(
        replies_.granted(detection.id, seen->number, 0, "thing " + std::to_string(seen->number) + kWasDropped),
        content);
  }
  const Thing& thing = *sightings_.find(seen->number);
  answers_.give(
      replies_.granted(detection.id, thing.number, thing.sightings,
                       "thing " + std::to_string(thing.number) + (seen->is_new ? ", a new one" : ", seen before")),
      content);
  if (seen->moved_to) move(thing, *seen->moved_to);
  list_.set(sightings_.list());
}

Result<Sightings::Seen> DetectionsNode::see(const Detection& detection) {
  if (detection.score < kLeastScore) {
    return refuse(Code::kLowScore, "its score is below 0.5");
  }
  const auto asset = asset_called(detection.asset);
  if (!asset) return tl::unexpected(asset.error());
  const auto T_map_frame = parts_.selection.T_map_frame(detection.frame);
  if (!T_map_frame) return tl::unexpected(T_map_frame.error());
  const Transform T_map_asset = *T_map_frame * detection.T_frame_asset;
  if (T_map_asset.translation().cwiseAbs().maxCoeff() >= kMaxVoxel * context_.site.resolution) {
    return refuse(Code::kOutOfBounds, "it lies beyond the map's bounds");
  }
  follow_injections();
  return sightings_.see(detection, (*asset)->name, (*asset)->class_name, T_map_asset, context_.bus.now());
}

Result<const Asset*> DetectionsNode::asset_called(const std::string& name) const {
  const auto& all = parts_.assets.assets();
  if (const auto it = all.find(name); it != all.end()) return &it->second;
  const Asset* found = nullptr;
  for (const auto& [key, asset] : all) {
    if (asset.class_name != name) continue;
    if (found != nullptr) return refuse(Code::kBadRequest, "several assets are of class " + name + "; name the asset");
    found = &asset;
  }
  if (found == nullptr) return refuse(Code::kNotFound, "no asset " + name + "; see: concord asset list");
  return found;
}

/// Taken from the store a hundred at a time: what a person says of a thing from before a restart is not said of
/// another.
Result<std::int64_t> DetectionsNode::next_number() {
  if (number_ > last_number_) {
    const auto taken = parts_.store.take_thing_numbers(kNumbersAtOnce);
    if (!taken) return taken;
    number_ = *taken;
    last_number_ = *taken + kNumbersAtOnce - 1;
  }
  return number_++;
}

void DetectionsNode::on_decision(const DetectionDecision& decision) {
  const std::uint64_t content = content_without_time(decision);
  if (parts_.assets.ask_again(decision.id, content)) return;
  if (answers_.repeat(decision.id, context_.process, content, decision.utime)) return;
  follow_injections();
  const auto thing = open_thing(decision);
  if (!thing) return answers_.give(replies_.denied(kDecisions, decision.id, thing.error()), content, decision.utime);
  if (decision.op == DetectionDecision::Op::kConfirm) return confirm(decision, content, **thing);
  sightings_.drop(decision.thing);
  list_.set(sightings_.list());
  answers_.give(replies_.granted(decision.id, 0, 1, "dropped"), content);
}

/// What nobody has decided on yet.
Result<const Thing*> DetectionsNode::open_thing(const DetectionDecision& decision) const {
  const Thing* thing = sightings_.find(decision.thing);
  if (thing == nullptr) {
    return refuse(Code::kNotFound, "no thing " + std::to_string(decision.thing) + "; see: concord things");
  }
  if (!thing->injection.empty()) {
    return refuse(Code::kConflict, "it is confirmed, by " + thing->injection + "; concord asset delete takes it out");
  }
  const auto other = std::ranges::find(confirmed_, decision.thing, [](const auto& entry) { return entry.second; });
  if (other != confirmed_.end()) return refuse(Code::kConflict, "it is just being confirmed, by " + other->first);
  return thing;
}

/// The assets' node answers, with how well it fits. Asked again, the place that was found first holds.
void DetectionsNode::confirm(const DetectionDecision& decision, std::uint64_t content, const Thing& thing) {
  AssetRequest request;
  request.id = decision.id;
  request.author = decision.author;
  request.asset = thing.asset;
  request.T_map_asset = thing.T_map_asset;
  request.utime = decision.utime;
  confirmed_[decision.id] = thing.number;
  parts_.assets.put(request, content,
                    AssetsNode::Fitting{[this](const BrickMasks&) { return occupied_of(parts_.map); },
                                        [](const ObjectFit& fit) { return words(fit); }});
}

/// Whoever sees it elsewhere may be off: what fits where it lies already is not moved. The model's own voxels are
/// occupied, and would hold it where it is.
void DetectionsNode::move(const Thing& thing, const Transform& T_map_asset) {
  const auto& placed = parts_.assets.injections().placed();
  const auto there = placed.find(thing.injection);
  if (there == placed.end()) return;
  if (parts_.labels.moved_voxels() >= kMostMovedVoxels) {
    return context_.counters.refused(
        "move_seen", {Code::kTooLarge, "moves have taken a quarter of the room for labels; " + thing.injection +
                                           " stays where it is: move it by hand"});
  }
  AssetRequest request;
  request.id = "seen-" + std::to_string(thing.number) + "-" + std::to_string(context_.bus.now());
  request.author = thing.author;
  request.op = AssetRequest::Op::kMove;
  request.of = thing.injection;
  request.T_map_asset = T_map_asset;
  request.utime = context_.bus.now();
  // A person who moves it meanwhile, or takes it out, knows better.
  const auto judge = [this, number = thing.number, of = thing.injection,
                      from = there->second.edit_id](const ObjectFit& fit) -> std::optional<std::string> {
    const auto& in_map = parts_.assets.injections().placed();
    const auto still = in_map.find(of);
    const Thing* now = sightings_.find(number);
    if (now == nullptr || still == in_map.end() || still->second.edit_id != from) return std::nullopt;
    if (!is_same_place(now->T_map_asset, fit.T_map_model)) return words(fit);
    sightings_.seen_there(number);
    return std::nullopt;
  };
  parts_.assets.put(request, content_of(encode(request)),
                    AssetsNode::Fitting{[this](const BrickMasks& present) { return surface_without(present); }, judge});
}

/// What is occupied, but of the voxels of the model itself only those that somebody sees.
BrickMasks DetectionsNode::surface_without(const BrickMasks& present) {
  BrickMasks unseen;
  for (const VoxelIndex voxel : present.voxels()) {
    if (!is_seen(voxel)) unseen.insert(voxel);
  }
  BrickMasks surface = occupied_of(parts_.map);
  surface.erase(unseen);
  return surface;
}

bool DetectionsNode::is_seen(VoxelIndex voxel) const {
  const Eigen::Vector3d p_map = centre_of(voxel, context_.site.resolution);
  return std::ranges::any_of(parts_.layers.now(), [&](const auto& entry) {
    const AgentLayer& layer = entry.second;
    if (!layer.T_map_agent) return false;
    return is_occupied(layer.map.at(voxel_of(layer.T_map_agent->inverse() * p_map, context_.site.resolution)));
  });
}

/// Where things are that are in the map is for the labels to say: people move them, take them out, bring them back.
void DetectionsNode::follow_injections() {
  const auto& all = parts_.assets.injections().placed();
  std::erase_if(confirmed_, [&](const auto& entry) {
    return !all.contains(entry.first) && !parts_.assets.is_under_way(entry.first);  // it was refused
  });
  std::set<std::string> followed;
  for (const Thing& thing : sightings_.list()) {
    if (thing.injection.empty()) continue;
    const auto there = all.find(thing.injection);
    if (there == all.end()) {
      sightings_.forget(thing.number);
      continue;
    }
    followed.insert(thing.injection);
    if (there->second.what.T_map_asset.matrix() != thing.T_map_asset.matrix()) {
      sightings_.put(thing.number, thing.injection, there->second.what.T_map_asset);
    }
  }
  for (const auto& [injection, there] : all) {
    if (followed.contains(injection)) continue;
    const auto under_way = confirmed_.find(injection);
    if (under_way != confirmed_.end() && sightings_.find(under_way->second) != nullptr) {
      sightings_.put(under_way->second, injection, there.what.T_map_asset);
      confirmed_.erase(under_way);
    } else {
      sightings_.add(there.what.asset, parts_.assets.class_of(there), injection, there.what.T_map_asset);
    }
  }
}

}  // namespace concord
