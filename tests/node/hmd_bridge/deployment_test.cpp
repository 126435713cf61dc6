// The paper's deployment: a saved map is loaded, a headset is aligned to it, sees a robot and places it, and asks for a
// path: through the true glass before somebody draws it, and round it after.

#include <unistd.h>

#include <filesystem>

#include "../../unit/align/rooms.hpp"
#include "bridge_test.hpp"
#include "submaps.hpp"

namespace concord::hmd {
namespace {

using test::kT_left_right;
using test::metres_off;
using test::right_part;
using test::room;
using test::transform;
using test::voxels_of;

/// A pane that no sensor returned, in the room: across from the wall to 0.6, 2 m high.
constexpr double kGlassX = -1.2, kGlassLow = -2.2, kGlassHigh = 0.6;

/// The room with all that its walls enclose seen to be free.
BrickMap surveyed_room() {
  const BrickMap walls = voxels_of(room());
  std::map<BrickIndex, DenseBrick> bricks;
  const auto put = [&](VoxelIndex voxel, LogOdds value) {
    const auto [it, is_new] = bricks.try_emplace(brick_of(voxel));
    if (is_new) it->second.fill(kUnknown);
    it->second[static_cast<std::size_t>(local_of(voxel))] = value;
  };
  for (int z = 1; z < 52; ++z) {
    for (int y = -43; y < 45; ++y) {
      for (int x = -59; x < 59; ++x) put({x, y, z}, kFree);
    }
  }
  walls.for_each_brick([&](BrickIndex index, const Brick& brick) {
    brick.for_each([&](int local, LogOdds value) { put(voxel_at(index, local), value); });
  });
  BrickMap map;
  for (const auto& [index, dense] : bricks) map.set(index, Brick::from_dense(dense));
  return map;
}

/// Whether a path goes through the pane.
bool crosses_glass(const Json& path) {
  const Json& points = path["points"];
  for (std::size_t i = 1; i < points.size(); ++i) {
    const auto a = points[i - 1]["p"].get<std::array<double, 3>>(), b = points[i]["p"].get<std::array<double, 3>>();
    if ((a[0] < kGlassX) == (b[0] < kGlassX)) continue;
    const double y = a[1] + (b[1] - a[1]) * (kGlassX - a[0]) / (b[0] - a[0]);
    if (y > kGlassLow && y < kGlassHigh) return true;
  }
  return false;
}

TEST(Deployment, APathCrossesTheTrueGlassBeforeTheEditAndNotAfter) {
  const std::filesystem::path kept = "/dev/shm/concord-office-" + std::to_string(getpid()) + ".bt";
  {
    Lab lab(Lab::kAll, test::kResolution);
    Client ana(lab);
    ASSERT_TRUE(has_code(ana.hello(), "OK"));
    lab.agent_maps("survey", surveyed_room());
    ASSERT_TRUE(has_code(ana.ask(PlaceRequest{"survey", kHere}), "OK"));
    lab.run(3);
    ASSERT_TRUE(has_code(ana.ask(SaveRequest{"office", {Format::kBt}, false}), "OK"));
    std::filesystem::rename(lab.site.state / "maps" / "office.bt", kept);
  }

  Lab lab(Lab::kAll, test::kResolution);
  std::filesystem::create_directories(lab.site.state / "maps");
  std::filesystem::rename(kept, lab.site.state / "maps" / "office.bt");
  Client ana(lab);
  ASSERT_TRUE(has_code(ana.hello("quest"), "OK"));
  ana.note(TrackingNotice{Tracking::kOk, "local1", kHere, {}});
  ASSERT_TRUE(has_code(ana.ask(LoadRequest{"office", {}, {}}), "OK"));

  const VoxelLook look = look_of(voxels_of(right_part()));
  const auto chunks = static_cast<std::uint32_t>(look.chunks.size());
  ASSERT_TRUE(has_code(ana.upload(FrameKind::kVoxels, chunks, 0, voxels_payload(look)), "OK"));
  lab.run(3);
  const Json found = ana.ask(AlignRequest{"quest", "office", pose_of(transform(0.5, -0.4, 0.2, 0.3) * kT_left_right)});
  ASSERT_TRUE(has_code(found, "OK"));
  ASSERT_TRUE(has_code(ana.ask(AlignAcceptRequest{found["answer"]["align"]}), "OK"));
  lab.run(2);

  // The robot sends nothing but its pose, in a frame that nobody knows. It really stands at (-2.2, -1.5), facing the
  // pane.
  const Transform T_map_base = transform(-2.2, -1.5, 0, 0), T_odom_base = transform(7, 3, 0, 1);
  const auto say = [&] {
    lab.bus->publish("in/cart/pose", encode(AgentPose{"cart", "odom", T_odom_base, lab.bus->now()}));
    lab.bus->deliver();
  };
  say();
  lab.run(1.5);
  say();
  const Pose seen = pose_of(kT_left_right.inverse() * T_map_base);
  ASSERT_TRUE(has_code(ana.ask(RobotCorrectRequest{"cart", Frame::kOwn, seen, lab.bus->now(), {}}), "OK"));
  lab.run(1.5);
  say();
  lab.run(0.5);
  const Json pose = ana.ask(RobotPoseRequest{"cart"});
  ASSERT_TRUE(has_code(pose, "OK"));
  EXPECT_LT(metres_off(transform_of(pose["answer"]["T_map_base"]), T_map_base), 0.1);

  const PlanRequest plan{"cart", Frame::kMap, {}, {0.2, -1.5, 0}};
  const Json before = ana.ask(plan);
  ASSERT_TRUE(has_code(before, "OK"));
  EXPECT_TRUE(crosses_glass(before["answer"]["path"])) << before;

  const Area pane{
      {{kGlassX, kGlassLow, 0}, {kGlassX, kGlassHigh, 0}, {kGlassX, kGlassHigh, 2}, {kGlassX, kGlassLow, 2}}, 0.05};
  ASSERT_TRUE(has_code(ana.ask(add(pane)), "OK"));
  lab.run(1);
  const Json after = ana.ask(plan);
  ASSERT_TRUE(has_code(after, "OK"));
  EXPECT_FALSE(crosses_glass(after["answer"]["path"])) << after;
  EXPECT_GT(after["answer"]["path"]["length"], before["answer"]["path"]["length"]);
}

}  // namespace
}  // namespace concord::hmd
