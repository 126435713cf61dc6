#include "players.hpp"

#include <algorithm>
#include <array>

#include "building.hpp"

namespace concord::soak {
namespace {

/// Where a zone lies. A transform is not the same to the last bit after its way through a quaternion; all else is.
Transform place(const Zone& zone) {
  const auto* box = std::get_if<OrientedBox>(&zone.volume);
  return box != nullptr ? zone.T_map_zone * box->T_frame_box : zone.T_map_zone;
}

Bytes all_else(Zone zone) {
  zone.utime = zone.revision = 0;
  zone.T_map_zone = Transform::Identity();
  if (auto* box = std::get_if<OrientedBox>(&zone.volume)) box->T_frame_box = Transform::Identity();
  ListPart<Zone> part;
  part.items = {std::move(zone)};
  return encode(part, 0);
}

}  // namespace

Robots::Robots(const test::Host& host, const std::map<std::string, BrickMap>& submaps) : station_(host) {
  host.inside([&] {
    for (const auto& [agent, map] : submaps) {
      const SubmapPublisher::Config config{agent, kResolution, 5e6, station_.bus().now()};
      auto& publisher = publishers_.emplace_back(
          std::make_unique<SubmapPublisher>(station_.bus(), station_.counters(), config, [] {}));
      publisher->begin_frame("frame1");
      publisher->publish(map);
    }
  });
}

Observer::Observer(const test::Host& host)
    : map_(host, "out/map", kResolution), conflicts_(host, "out/conflicts", kResolution), station_(host) {
  host.inside([&] {
    zones_ = std::make_unique<ListReceiver<Zone>>(station_.bus(), station_.counters(), "out/zones",
                                                  [](const std::vector<Zone>&) {});
  });
}

bool Observer::holds(const MergedMap& expected, const std::map<std::string, Zone>& zones) const {
  return map_.synced() && conflicts_.synced() && zones_->synced() && has_zones(zones) &&
         map_.map() == expected.values && conflicts_.map() == expected.conflicts;
}

std::string Observer::difference(const MergedMap& expected, const std::map<std::string, Zone>& zones) const {
  const auto bricks = [](const BrickMap& map) { return std::to_string(map.brick_count()) + " bricks"; };
  const auto compared = [&](const test::StreamCopy& copy, const BrickMap& wanted) {
    return std::string(copy.synced() ? "" : "not synced, ") + (copy.map() == wanted ? "equal" : "different") + ", " +
           bricks(copy.map()) + " of " + bricks(wanted);
  };
  return "map: " + compared(map_, expected.values) + "; conflicts: " + compared(conflicts_, expected.conflicts) +
         "; zones: " + (zones_->synced() ? "" : "not synced, ") + (has_zones(zones) ? "equal" : "different");
}

bool Observer::has_zones(const std::map<std::string, Zone>& zones) const {
  return std::ranges::equal(zones_->items(), zones, [](const Zone& held, const auto& expected) {
    return place(held).isApprox(place(expected.second), 1e-12) && all_else(held) == all_else(expected.second);
  });
}

Assassin::Assassin(test::Stack& stack, int kills, int requests, std::uint32_t seed) : stack_(stack), random_(seed) {
  for (int i = 0; i < kills; ++i) after_.insert(static_cast<int>(pick(1, requests)));
}

void Assassin::on_request(int number, std::int64_t now) {
  while (!after_.empty() && *after_.begin() <= number) {
    after_.erase(after_.begin());
    due_.insert(now + pick(0, 30'000));
  }
}

void Assassin::act(std::int64_t now) {
  if (down_ && now >= back_at_) {
    stack_.start(*down_);
    down_.reset();
  }
  if (down_ || due_.empty() || now < *due_.begin()) return;
  due_.erase(due_.begin());
  constexpr std::array kVictims = {"merge", "merge", "ingest", "planner"};
  down_ = kVictims[static_cast<std::size_t>(pick(0, 3))];
  stack_.kill(*down_);
  ++kills_[*down_];
  back_at_ = now + pick(0, 200'000);
}

std::int64_t Assassin::pick(std::int64_t low, std::int64_t high) {
  return std::uniform_int_distribution<std::int64_t>(low, high)(random_);
}

}  // namespace concord::soak
