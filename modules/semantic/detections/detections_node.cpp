#include "semantic/detections/detections_node.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "semantic/assets/injections.hpp"
#include "semantic/models/model_file.hpp"

namespace concord {
namespace {

const std::string kSeen = "in/detection", kDecisions = "in/detection_decision";
constexpr std::int64_t kPeriod = 1'000'000;
constexpr double kLeastScore = 0.5;

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
      list_(context.bus, context.counters, "out/things", context.site.stream.bytes_per_second) {
  listen<Detection>(context_.bus, context_.counters, context_.process, kSeen,
                    [this](const std::string&, const Detection& detection) { on_detection(detection); });
  listen<DetectionDecision>(context_.bus, context_.counters, context_.process, kDecisions,
                            [this](const std::string&, const DetectionDecision& decision) { on_decision(decision); });
  context_.bus.every(kPeriod, [this] {
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
  const auto T_map_frame = parts_.T_map_frame(detection.frame);
  if (!T_map_frame) return tl::unexpected(T_map_frame.error());
  const Transform T_map_asset = *T_map_frame * detection.T_frame_asset;
  if (T_map_asset.translation().cwiseAbs().maxCoeff() >= kMaxVoxel * context_.site.resolution) {
    return refuse(Code::kOutOfBounds, "it lies beyond the map's bounds");
  }
  follow_injections();
  return sightings_.see(detection, (*asset)->name, (*asset)->class_name, T_map_asset);
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

void DetectionsNode::on_decision(const DetectionDecision& decision) {
  follow_injections();
  const Thing* thing = sightings_.find(decision.thing);
  const auto under_way = confirmed_.find(decision.id);
  if (thing == nullptr) {
    return replies_.deny(kDecisions, decision.id,
                         {Code::kNotFound, "no thing " + std::to_string(decision.thing) + "; see: concord things"});
  }
  const bool is_repeat = thing->injection == decision.id || under_way != confirmed_.end();
  if (!thing->injection.empty() && !is_repeat) {
    return replies_.deny(
        kDecisions, decision.id,
        {Code::kConflict, "it is confirmed, by " + thing->injection + "; concord asset delete takes it out"});
  }
  if (decision.op == DetectionDecision::Op::kConfirm) return confirm(decision, *thing);
  sightings_.drop(decision.thing);
  list_.set(sightings_.list());
  replies_.grant(decision.id, 0, 1, "dropped");
}

/// The assets' node answers, with how well it fits. Asked again, the place that was found first holds.
void DetectionsNode::confirm(const DetectionDecision& decision, const Thing& thing) {
  AssetRequest request;
  request.id = decision.id;
  request.author = decision.author;
  request.asset = thing.asset;
  request.utime = decision.utime;
  if (parts_.assets.ask_again(request)) return;
  const auto fit = fitted(thing.asset, thing.T_map_asset);
  if (!fit) return replies_.deny(kDecisions, decision.id, fit.error());
  request.T_map_asset = fit->T_map_model;
  confirmed_[decision.id] = thing.number;
  parts_.assets.on_request(request, words(*fit));
}

void DetectionsNode::move(const Thing& thing, const Transform& T_map_asset) {
  const auto fit = fitted(thing.asset, T_map_asset);
  if (!fit) return context_.counters.refused(kSeen, fit.error());
  AssetRequest request;
  request.id = "seen-" + std::to_string(thing.number) + "-" + std::to_string(context_.bus.now());
  request.author = thing.author;
  request.op = AssetRequest::Op::kMove;
  request.of = thing.injection;
  request.T_map_asset = fit->T_map_model;
  request.utime = context_.bus.now();
  parts_.assets.on_request(request, words(*fit));
}

Result<ObjectFit> DetectionsNode::fitted(const std::string& asset, const Transform& T_map_asset) const {
  const auto it = parts_.assets.assets().find(asset);
  if (it == parts_.assets.assets().end()) return refuse(Code::kNotFound, "no asset " + asset + " any more");
  return read_model_file(context_.site.state / "assets" / it->second.file)
      .and_then(
          [&](const TriangleMesh& mesh) { return surface_points(mesh, it->second.unit, context_.site.resolution); })
      .map([&](const std::vector<Eigen::Vector3d>& points) {
        return fit_object(points, occupied_of(parts_.map), context_.site.resolution, T_map_asset);
      });
}

/// Where things are that are in the map is for the labels to say: people move them, take them out, bring them back.
void DetectionsNode::follow_injections() {
  const auto all = placed(parts_.labels);
  std::set<std::string> followed;
  for (const Thing& thing : sightings_.list()) {
    if (thing.injection.empty()) continue;
    const auto there = all.find(thing.injection);
    if (there == all.end()) {
      sightings_.drop(thing.number);
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
      sightings_.add(there.what.asset, parts_.labels.classes().at(there.of.label).name, injection,
                     there.what.T_map_asset);
    }
  }
}

}  // namespace concord
