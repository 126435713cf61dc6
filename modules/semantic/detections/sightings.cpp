#include "semantic/detections/sightings.hpp"

#include <algorithm>

namespace concord {
namespace {

constexpr double kMostWeight = 10.0;

double distance(const Transform& a, const Transform& b) { return (a.translation() - b.translation()).norm(); }
double turn(const Transform& a, const Transform& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

/// From `a` a share of the way to `b`.
Transform between(const Transform& a, const Transform& b, double share) {
  Transform out = Transform::Identity();
  const Eigen::Quaterniond from(a.linear()), to(b.linear());
  out.linear() = from.slerp(share, to).normalized().toRotationMatrix();
  out.translation() = (1 - share) * a.translation() + share * b.translation();
  return out;
}

}  // namespace

Sightings::Kept* Sightings::thing_of(const Detection& detection, const std::string& asset,
                                     const Transform& T_map_asset) {
  if (const auto known = followed_.find({detection.author, detection.object}); known != followed_.end()) {
    Kept& kept = things_.at(known->second);
    if (kept.thing.asset == asset) return &kept;
  }
  Kept* nearest = nullptr;
  double least = kSameThing;
  for (auto& [number, kept] : things_) {
    if (kept.thing.asset != asset) continue;
    double away = distance(kept.thing.T_map_asset, T_map_asset);
    if (kept.agreeing > 0) away = std::min(away, distance(kept.elsewhere, T_map_asset));
    if (away < least) least = away, nearest = &kept;
  }
  return nearest;
}

bool Sightings::make_room() {
  if (things_.size() < kMaxThings) return true;
  const auto oldest = std::ranges::min_element(things_, {}, [](const auto& entry) {
    return std::pair(!entry.second.thing.injection.empty(), entry.second.thing.last_seen);
  });
  if (!oldest->second.thing.injection.empty()) return false;
  drop(oldest->first);
  return true;
}

Result<Sightings::Seen> Sightings::see(const Detection& detection, const std::string& asset,
                                       const std::string& class_name, const Transform& T_map_asset) {
  Kept* kept = thing_of(detection, asset, T_map_asset);
  Seen seen;
  if (kept == nullptr) {
    if (!make_room()) return refuse(Code::kTooLarge, "no more things can be told apart; drop some");
    seen.is_new = true;
    kept = &things_[++last_number_];
    kept->thing.number = last_number_;
    kept->thing.asset = asset;
    kept->thing.T_map_asset = T_map_asset;
  }
  Thing& thing = kept->thing;
  seen.number = thing.number;
  thing.class_name = class_name;
  thing.score = std::max(thing.score, detection.score);
  thing.sightings = std::min(thing.sightings, 1 << 30) + 1;
  thing.last_seen = std::max(thing.last_seen, detection.utime);
  thing.author = detection.author;
  if (!detection.object.empty()) followed_[{detection.author, detection.object}] = thing.number;

  const bool is_there =
      distance(thing.T_map_asset, T_map_asset) <= kMoved && turn(thing.T_map_asset, T_map_asset) <= kTurned;
  if (thing.injection.empty()) {
    if (distance(thing.T_map_asset, T_map_asset) > kSameThing) kept->weight = 0;  // it was followed there
    const double weight = std::max(detection.score, 1e-3);
    kept->weight = std::min(kept->weight + weight, kMostWeight);
    thing.T_map_asset = between(thing.T_map_asset, T_map_asset, std::min(1.0, weight / kept->weight));
  } else if (is_there) {
    kept->agreeing = 0;
  } else {
    const bool agrees = kept->agreeing > 0 && distance(kept->elsewhere, T_map_asset) <= kMoved;
    kept->agreeing = agrees ? kept->agreeing + 1 : 1;
    kept->elsewhere = agrees ? between(kept->elsewhere, T_map_asset, 1.0 / kept->agreeing) : T_map_asset;
    if (kept->agreeing >= kAgreeing) {
      seen.moved_to = kept->elsewhere;
      kept->agreeing = 0;
    }
  }
  return seen;
}

const Thing* Sightings::find(std::int64_t number) const {
  const auto it = things_.find(number);
  return it != things_.end() ? &it->second.thing : nullptr;
}

void Sightings::add(const std::string& asset, const std::string& class_name, const std::string& injection,
                    const Transform& T_map_asset) {
  if (!make_room()) return;  // then it is not followed, and stays where it is
  Thing& thing = things_[++last_number_].thing;
  thing.number = last_number_;
  thing.asset = asset;
  thing.class_name = class_name;
  thing.injection = injection;
  thing.T_map_asset = T_map_asset;
}

void Sightings::put(std::int64_t number, const std::string& injection, const Transform& T_map_asset) {
  Kept& kept = things_.at(number);
  kept.thing.injection = injection;
  kept.thing.T_map_asset = T_map_asset;
  kept.agreeing = 0;
}

void Sightings::drop(std::int64_t number) {
  things_.erase(number);
  std::erase_if(followed_, [number](const auto& entry) { return entry.second == number; });
}

std::vector<Thing> Sightings::list() const {
  std::vector<Thing> out;
  for (const auto& [number, kept] : things_) out.push_back(kept.thing);
  return out;
}

}  // namespace concord
