// Robots that are not round, on a planner of the test's own: searches run beside it, here whenever the test has them
// run.
#pragma once

#include <gtest/gtest.h>

#include "planner/planner.hpp"
#include "planner/se2/pose_check.hpp"
#include "sketch.hpp"
#include "zones.hpp"

namespace concord::test {

using Rows = std::vector<std::string>;
constexpr std::int64_t kSecond = 1'000'000;

/// Quarter-metre cells: two rooms, 9 m each, with two doors of 2 m between them.
inline Rows two_rooms() {
  Rows rows(48, std::string(80, '.'));
  for (std::size_t y = 0; y < rows.size(); ++y) {
    for (std::size_t x = 0; x < rows[y].size(); ++x) {
      const bool is_door = (y >= 6 && y < 14) || (y >= 34 && y < 42);
      if (y == 0 || x == 0 || y == 47 || x == 79 || (x == 40 && !is_door)) rows[y][x] = '#';
    }
  }
  return rows;
}

inline Rows with_box(Rows rows, Cell low, Cell high, char c) {
  for (int y = low.y; y <= high.y; ++y) {
    for (int x = low.x; x <= high.x; ++x) rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = c;
  }
  return rows;
}

class ActivePoses : public testing::Test {
 protected:
  ActivePoses() { planner_.set_zones({}); }

  void show(const Rows& rows) {
    const Grid wanted = sketch(rows, {}, 0.25);
    wanted.cells().for_each_brick([&](BrickIndex index, const Brick& brick) { planner_.set_brick(index, brick); });
    planner_.project();
    ++revision_;
    utime_ += kSecond;
  }
  [[nodiscard]] Planner::Moment now() const { return {revision_, utime_}; }
  static PathRequest across(const std::string& id) {
    PathRequest request;
    request.id = id;
    request.robot = "robot1";
    request.start = Eigen::Vector2d(3, 2.5);
    request.goal = {16, 2.5};
    request.goal_yaw = M_PI / 2;
    request.keep_active = true;
    return request;
  }
  static Robot fork_lift(double length = 1.2, double width = 0.8, double turn_radius = 0.4) {
    return {0, 0.5, Body{*make_rectangle(length, width), turn_radius}, {}};
  }
  /// Runs what is to be searched until nothing is.
  void search() {
    while (const auto quest = planner_.next_quest()) quest->run();
  }
  Path ask(const PathRequest& request, const Robot& robot) {
    planner_.serve(now());
    if (const auto reply = planner_.request(request, robot, now()); reply.path) return *reply.path;
    for (int i = 0; i < 10; ++i) {
      search();
      for (const Planner::Reply& reply : planner_.serve(now())) {
        if (reply.path && reply.path->id == request.id) return *reply.path;
      }
    }
    ADD_FAILURE() << "no answer";
    return {};
  }
  std::vector<Path> replan() {
    planner_.serve(now());
    return planner_.replan(now());
  }

  /// By the validator, on a grid of the test's own.
  bool is_valid(const Path& path) const {
    OpenGrid open(80, 48);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 80; ++x) {
        open.set({x, y}, is_free(planner_.grid().at({x, y})) && planner_.zones().no_go_at({x, y}) == nullptr);
      }
    }
    const auto footprint = Footprint::make(path.footprint);
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < path.points.size(); ++i) {
      poses.push_back({path.points[i].head<2>(), path.details[i].yaw});
    }
    if (poses.empty() || !footprint) return false;
    const auto fault = fault_of({open, 0.25, *footprint, path.turn_radius, poses.front(), poses.back()}, poses);
    EXPECT_FALSE(fault) << *fault;
    return !fault;
  }

  Planner planner_{Grid(0.25, make_band(0, 0.25, 0.25).value(), 0.5)};
  std::int64_t revision_ = 0;
  std::int64_t utime_ = 1'700'000'000'000'000;
};

}  // namespace concord::test
