#pragma once

#include "planner/planner_node.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "bus/lockstep_bus.hpp"

namespace concord {

inline constexpr std::int64_t kStart = 1'700'000'000'000'000;

/// 4 x 2 bricks of free space one metre high (0.1 m voxels), 3.2 m by 1.6 m.
inline BrickMap hall() {
  VoxelMask all;
  all.fill(~std::uint64_t{0});
  BrickMap map;
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 2; ++y) map.set({x, y, 0}, Brick::uniform(all, kFree));
  }
  return map;
}

/// The planner between a merge process that sends the map and a headset that reads everything.
class PlannerOnTheBus : public testing::Test {
 protected:
  PlannerOnTheBus() {
    listen<BrickPacket>(bus_, counters_, "test", "out/grid/bricks",
                        [this](const std::string&, const BrickPacket& p) { grid_receiver_.on_packet(p); });
    listen<BrickDigest>(bus_, counters_, "test", "out/grid/digest",
                        [this](const std::string&, const BrickDigest& d) { grid_receiver_.on_digest(d); });
    listen<Path>(bus_, counters_, "test", "out/path/robot1",
                 [this](const std::string&, const Path& path) { paths_.push_back(path); });
    listen<Answer>(bus_, counters_, "test", kAnswers,
                   [this](const std::string&, const Answer& value) { answers_.push_back(value); });
  }

  void start_with_zones() {
    start_planner(kStart);
    say_zones();
  }

  static Site make_site() {
    Site site;
    site.resolution = 0.1;
    site.planner.zmin = 0.0;
    site.planner.zmax = 0.8;
    site.unlisted.radius = 0.2;
    return site;
  }

  /// Merge's list; without any, that there are none.
  void say_zones(const std::vector<Zone>& zones = {}) {
    zone_sender_.set(zones);
    bus_.deliver();
  }
  static Zone zone(const std::string& name, Zone::Kind kind, Eigen::Vector2d min, Eigen::Vector2d max) {
    Zone zone;
    zone.name = name;
    zone.kind = kind;
    zone.volume = Box{{min.x(), min.y(), 0}, {max.x(), max.y(), 2}};
    zone.author = "anna";
    return zone;
  }

  void start_planner(std::int64_t boot_id) { node_.emplace(NodeContext{bus_, counters_, site_, "planner", boot_id}); }
  void run_seconds(double seconds) {
    bus_.advance_to(bus_.now() + static_cast<std::int64_t>(seconds * 1e6));
    bus_.deliver();
  }
  void set(BrickIndex index, Brick brick) {
    map_.set(index, std::move(brick));
    map_sender_.touch(index);
  }
  void ask(const std::string& id, std::optional<Eigen::Vector2d> start, bool keep_active) {
    PathRequest request;
    request.id = id;
    request.robot = "robot1";
    request.start = start;
    request.goal = {2.8, 0.8};
    request.keep_active = keep_active;
    bus_.publish("in/path_request", encode(request, bus_.now()));
    bus_.deliver();
  }

  LockstepBus bus_{kStart};
  Counters counters_;
  Site site_ = make_site();
  BrickMap map_ = hall();
  BrickSender map_sender_{bus_, counters_, {.stream = "out/map", .resolution = 0.1, .boot_id = kStart}, map_};
  ListSender<Zone> zone_sender_{bus_, counters_, "out/zones", 5e6};
  std::optional<PlannerNode> node_;
  BrickMap grid_;
  std::vector<Path> paths_;
  std::vector<Answer> answers_;
  BrickReceiver grid_receiver_{
      bus_,
      counters_,
      {.stream = "out/grid", .resolution = 0.1},
      {.on_frame = [this](const std::string&) { grid_.clear(); },
       .on_brick = [this](BrickIndex index, Brick brick) { grid_.set(index, std::move(brick)); },
       .on_end = {}}};
};

}  // namespace concord
