#include "semantic/detections/sightings.hpp"

#include <algorithm>
#include <iterator>
#include <tuple>

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

bool is_same_place(const Transform& a, const Transform& b) { return distance(a, b) <= kMoved && turn(a, b) <= kTurned; }

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
    if (kept.seen_at) away = std::min(away, distance(*kept.seen_at, T_map_asset));
    if (away < least) least = away, nearest = &kept;
  }
  return nearest;
}

bool Sightings::make_room() {
  if (things_.size() < kMaxThings) return true;
  const auto oldest = std::ranges::min_element(things_, {}, [](const auto& entry) {
    const Kept& kept = entry.second;
    return std::tuple(!kept.thing.injection.empty(), !kept.is_dropped, kept.heard);
  });
  if (!oldest->second.thing.injection.empty()) return false;
  forget(oldest->first);
  return true;
}

Result<Sightings::Kept*> Sightings::add_thing(const std::string& asset, const Transform& T_map_asset) {
  if (!make_room()) return refuse(Code::kTooLarge, "no more things can be told apart; drop some");
  const auto number = next_number_();
  if (!number) return tl::unexpected(number.error());
  Kept& kept = things_[*number];
  kept.thing.number = *number;
  kept.thing.asset = asset;
  kept.thing.T_map_asset = T_map_asset;
  return &kept;
}

/// Who follows it has one name for it, the latest.
void Sightings::follow(const Detection& detection, Kept& kept) {
  if (detection.object.empty()) return;
  const std::pair key(detection.author, detection.object);
  if (const auto was = followed_.find(key); was != followed_.end()) things_.at(was->second).names.erase(key.first);
  if (const auto before = kept.names.find(detection.author); before != kept.names.end()) followed_.erase(*before);
  kept.names[detection.author] = detection.object;
  followed_[key] = kept.thing.number;
  if (kept.names.size() <= kMostFollowers) return;
  const auto other = kept.names.begin()->first != detection.author ? kept.names.begin() : std::next(kept.names.begin());
  followed_.erase(*other);
  kept.names.erase(other);
}

bool Sightings::lies_at(const Kept& kept, const Transform& T_map_asset) {
  return is_same_place(kept.thing.T_map_asset, T_map_asset) ||
         (kept.seen_at && is_same_place(*kept.seen_at, T_map_asset));
}

Result<Sightings::Seen> Sightings::see(const Detection& detection, const std::string& asset,
                                       const std::string& class_name, const Transform& T_map_asset, std::int64_t now) {
  Kept* kept = thing_of(detection, asset, T_map_asset);
  Seen seen;
  if (kept == nullptr) {
    const auto added = add_thing(asset, T_map_asset);
    if (!added) return tl::unexpected(added.error());
    kept = *added;
    seen.is_new = true;
  }
  Thing& thing = kept->thing;
  seen.number = thing.number;
  thing.class_name = class_name;
  thing.score = std::max(thing.score, detection.score);
  thing.sightings = std::min(thing.sightings, 1 << 30) + 1;
  thing.last_seen = std::max(thing.last_seen, detection.utime);
  kept->heard = now;
  seen.is_dropped = kept->is_dropped;
  thing.author = detection.author;
  if (!kept->is_dropped) follow(detection, *kept);

  if (thing.injection.empty()) {
    if (distance(thing.T_map_asset, T_map_asset) > kSameThing) kept->weight = 0;  // it was followed there
    const double weight = std::max(detection.score, 1e-3);
    kept->weight = std::min(kept->weight + weight, kMostWeight);
    thing.T_map_asset = between(thing.T_map_asset, T_map_asset, std::min(1.0, weight / kept->weight));
  } else if (lies_at(*kept, T_map_asset)) {
    see_there(*kept, now);
  } else {
    see_elsewhere(*kept, T_map_asset, now, seen);
  }
  return seen;
}

void Sightings::see_there(Kept& kept, std::int64_t now) {
  kept.agreeing = 0;
  if (!kept.still_since) kept.still_since = now;
  if (now - *kept.still_since < kStill * kept.pause) return;
  kept.pause = std::max(kept.pause / 2, kFirstPause);
  kept.still_since = now;
}

void Sightings::see_elsewhere(Kept& kept, const Transform& T_map_asset, std::int64_t now, Seen& seen) {
  const bool agrees = kept.agreeing > 0 && distance(kept.elsewhere, T_map_asset) <= kMoved;
  kept.agreeing = agrees ? std::min(kept.agreeing + 1, 10) : 1;
  kept.elsewhere = agrees ? between(kept.elsewhere, T_map_asset, 1.0 / kept.agreeing) : T_map_asset;
  if (kept.agreeing < kAgreeing) return;
  kept.still_since.reset();
  if (now < kept.next_move) return;
  seen.moved_to = kept.elsewhere;
  kept.next_move = now + kept.pause;
  kept.pause = std::min(2 * kept.pause, kLongestPause);
}

const Thing* Sightings::find(std::int64_t number) const {
  const auto it = things_.find(number);
  return it != things_.end() && !it->second.is_dropped ? &it->second.thing : nullptr;
}

void Sightings::add(const std::string& asset, const std::string& class_name, const std::string& injection,
                    const Transform& T_map_asset) {
  forget_dropped_at(asset, T_map_asset);
  const auto added = add_thing(asset, T_map_asset);
  if (!added) return;  // then it is not followed, and stays where it is
  (*added)->thing.class_name = class_name;
  (*added)->thing.injection = injection;
}

/// Where it was seen before it was put is where it is seen there, if the fit took it no farther than a fit may.
void Sightings::put(std::int64_t number, const std::string& injection, const Transform& T_map_asset) {
  Kept& kept = things_.at(number);
  forget_dropped_at(kept.thing.asset, T_map_asset);
  std::optional<Transform> seen;
  if (kept.thing.injection.empty()) {
    seen = kept.thing.T_map_asset;
  } else if (kept.agreeing > 0) {
    seen = kept.elsewhere;
  }
  if (seen && distance(*seen, T_map_asset) > kSameThing) seen.reset();
  kept.seen_at = seen;
  kept.thing.injection = injection;
  kept.thing.T_map_asset = T_map_asset;
  kept.agreeing = 0;
}

void Sightings::seen_there(std::int64_t number) {
  Kept& kept = things_.at(number);
  kept.seen_at = kept.elsewhere;
  kept.agreeing = 0;
}

void Sightings::forget(std::int64_t number) {
  const auto it = things_.find(number);
  if (it == things_.end()) return;
  for (const auto& name : it->second.names) followed_.erase(name);
  things_.erase(it);
}

void Sightings::drop(std::int64_t number) {
  const auto it = things_.find(number);
  if (it == things_.end()) return;
  it->second.is_dropped = true;
  for (const auto& name : it->second.names) followed_.erase(name);
  it->second.names.clear();
}

void Sightings::forget_dropped(std::int64_t now) {
  forget_those([&](const Kept& kept) { return kept.is_dropped && now - kept.heard >= kDroppedFor; });
}

/// Else it would go on swallowing what is seen of the one that is there now.
void Sightings::forget_dropped_at(const std::string& asset, const Transform& T_map_asset) {
  forget_those([&](const Kept& kept) {
    return kept.is_dropped && kept.thing.asset == asset && distance(kept.thing.T_map_asset, T_map_asset) <= kSameThing;
  });
}

template <class Which>
void Sightings::forget_those(Which which) {
  std::vector<std::int64_t> numbers;
  for (const auto& [number, kept] : things_) {
    if (which(kept)) numbers.push_back(number);
  }
  for (const std::int64_t number : numbers) forget(number);
}

std::vector<Thing> Sightings::list() const {
  std::vector<Thing> out;
  for (const auto& [number, kept] : things_) {
    if (!kept.is_dropped) out.push_back(kept.thing);
  }
  return out;
}

}  // namespace concord
