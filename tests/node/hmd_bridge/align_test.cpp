// Alignment: asked, found, accepted, undone, refused; a headset that refers itself to a robot it sees.

#include "../../unit/align/rooms.hpp"
#include "bridge_test.hpp"
#include "submaps.hpp"

namespace concord::hmd {
namespace {

using test::corridor;
using test::kT_left_right;
using test::left_part;
using test::metres_off;
using test::other_room;
using test::right_part;
using test::transform;
using test::voxels_of;

constexpr double kNear = 0.08;  // metres: both are in voxels of 0.05

class Aligning : public Bridge {
 protected:
  Aligning() : Bridge(test::kResolution) {}
  void SetUp() override {
    ASSERT_EQ(code_of_answer(ana.hello()), "OK");
    lab.agent_maps("robot1", voxels_of(left_part()));
  }
  Json agent(const std::string& id) {
    const Json agents = ana.ask(AgentsRequest{})["answer"]["agents"];
    for (const Json& one : agents) {
      if (one["agent"] == id) return one;
    }
    return {};
  }
  /// Off by what people are off by.
  static Pose rough(const Transform& T) { return pose_of(transform(0.5, -0.4, 0.2, 0.3) * T); }
};

TEST_F(Aligning, TheFirstPairFoundsTheMapAndALaterPlaceIsUndone) {
  lab.agent_maps("robot2", voxels_of(right_part()));
  const Json found = ana.ask(AlignRequest{"robot2", "robot1", rough(kT_left_right)});
  ASSERT_TRUE(has_code(found, "OK"));
  EXPECT_LT(metres_off(transform_of(found["answer"]["T_target_source"]), kT_left_right), kNear);
  EXPECT_GT(found["answer"]["evidence"]["overlap"], 0.4);
  EXPECT_GT(found["answer"]["evidence"]["iterations"], 0);
  EXPECT_FALSE(agent("robot2")["aligned"].get<bool>()) << "moved before anybody accepted it";

  const Json accepted = ana.ask(AlignAcceptRequest{found["answer"]["align"]});
  ASSERT_TRUE(has_code(accepted, "OK"));
  EXPECT_EQ(accepted["answer"]["agent"], "robot2");
  lab.run(1.5);
  EXPECT_LT(metres_off(transform_of(agent("robot2")["T_map_agent"]), kT_left_right), kNear);
  EXPECT_CODE(ana.ask(AlignUndoRequest{"robot2"}), "EXPIRED") << "it had no place before";

  const Transform before = transform_of(agent("robot2")["T_map_agent"]);
  const Json again = ana.ask(AlignRequest{"robot2", {}, rough(kT_left_right)});
  ASSERT_TRUE(has_code(again, "OK"));
  ASSERT_TRUE(has_code(ana.ask(PlaceRequest{"robot2", pose_of(transform(1, 0, 0, 0))}), "OK"));
  lab.run(1.5);
  EXPECT_CODE(ana.ask(AlignUndoRequest{"robot2"}), "OK");
  lab.run(1.5);
  EXPECT_LT(metres_off(transform_of(agent("robot2")["T_map_agent"]), before), 1e-6);
}

TEST_F(Aligning, WithoutAGuessItIsLookedForEverywhere) {
  lab.agent_maps("robot2", voxels_of(right_part()));
  EXPECT_CODE(ana.ask(PlaceRequest{"robot1", kHere}), "OK");
  lab.run(1.5);
  const Json found = ana.ask(AlignRequest{"robot2", {}, {}});
  ASSERT_TRUE(has_code(found, "OK"));
  EXPECT_LT(metres_off(transform_of(found["answer"]["T_target_source"]), kT_left_right), kNear);
}

TEST_F(Aligning, WhatCannotBeFoundIsRefusedForItsReason) {
  EXPECT_CODE(ana.ask(AlignRequest{"nobody", {}, {}}), "NO_AGENT");
  EXPECT_CODE(ana.ask(AlignRequest{"robot1", {}, {}}), "NO_MAP") << "nobody else is in the map";
  EXPECT_CODE(ana.ask(AlignRequest{"robot1", {}, Pose{{0, 0, 0}, {0, 0, 0, 0}}}), "BAD_REQUEST");
  lab.agent_maps("robot2", voxels_of(other_room()));
  const Json other = ana.ask(AlignRequest{"robot2", "robot1", rough(kT_left_right)});
  EXPECT_CODE(other, "LOW_OVERLAP");
  EXPECT_FALSE(agent("robot2")["aligned"].get<bool>());
  lab.agent_maps("robot3", voxels_of(corridor(0, 9)));
  lab.agent_maps("robot4", voxels_of(corridor(2, 11)));
  EXPECT_CODE(ana.ask(AlignRequest{"robot4", "robot3", kHere}), "DEGENERATE");
  test::Points bare;
  test::add_box(bare, {-2, -2, 0}, {2, 2, 2.5});
  lab.agent_maps("robot5", voxels_of(bare));
  lab.agent_maps("robot6", voxels_of(bare));
  EXPECT_CODE(ana.ask(AlignRequest{"robot6", "robot5", {}}), "AMBIGUOUS");
}

TEST_F(Aligning, MapsThatContradictEachOtherAreRefused) {
  test::Points before = test::room(), after = before;
  test::add_box(before, {-2.0, -1.9, 0.0}, {1.4, -1.6, 1.1}, false);
  test::add_box(after, {-2.0, -1.4, 0.0}, {1.4, -1.1, 1.1}, false);
  lab.agent_maps("robot2", voxels_of(before));
  lab.agent_maps("robot3", voxels_of(after));
  EXPECT_CODE(ana.ask(AlignRequest{"robot3", "robot2", kHere}), "DIVERGED");
  EXPECT_FALSE(agent("robot3")["aligned"].get<bool>());
  Client bert(lab);
  become_agent(bert, "quest", false);
  const VoxelLook look = look_of(voxels_of(after));
  EXPECT_CODE(bert.upload(FrameKind::kVoxels, static_cast<std::uint32_t>(look.chunks.size()), 0, voxels_payload(look)),
              "OK");
  lab.run(3);
  lab.bus->publish("in/robot2/pose", encode(AgentPose{"robot2", "odom", Transform::Identity(), lab.bus->now()}));
  lab.bus->deliver();
  EXPECT_CODE(bert.ask(ReferenceRequest{"robot2", kHere}), "DIVERGED");
}

TEST_F(Aligning, DecisionsHoldOnlyForWhatStands) {
  lab.agent_maps("robot2", voxels_of(right_part()));
  EXPECT_CODE(ana.ask(AlignAcceptRequest{"none"}), "EXPIRED");
  EXPECT_CODE(ana.ask(AlignDropRequest{"none"}), "EXPIRED");
  const Json found = ana.ask(AlignRequest{"robot2", "robot1", rough(kT_left_right)});
  ASSERT_TRUE(has_code(found, "OK"));
  const std::string align = found["answer"]["align"];
  EXPECT_CODE(ana.ask(AlignDropRequest{align}), "OK");
  EXPECT_CODE(ana.ask(AlignAcceptRequest{align}), "EXPIRED");
  const std::string second = ana.ask(AlignRequest{"robot2", "robot1", rough(kT_left_right)})["answer"]["align"];
  lab.agent_maps("robot2", voxels_of(right_part()));
  EXPECT_CODE(ana.ask(ResetRequest{"robot2"}), "OK");
  lab.run(2);
  EXPECT_CODE(ana.ask(AlignAcceptRequest{second}), "BAD_FRAME");
}

TEST_F(Aligning, AHeadsetRefersItselfToARobotThatItSees) {
  Client bert(lab);
  become_agent(bert, "quest", false);
  const Transform T_agent_base = transform(1, 0.5, 0, 0.2);
  // The headset's own frame lies in robot1's at kT_left_right: there it sees the robot's base.
  const Pose seen = rough(kT_left_right.inverse() * T_agent_base);
  EXPECT_CODE(bert.ask(ReferenceRequest{"robot1", seen}), "NO_MAP") << "it has scanned nothing";
  AgentPose pose{"robot1", "odom", T_agent_base, 0};
  const auto say = [&] {
    pose.utime = lab.bus->now();
    lab.bus->publish("in/robot1/pose", encode(pose));
    lab.bus->deliver();
  };
  const VoxelLook look = look_of(voxels_of(right_part()));
  EXPECT_CODE(bert.upload(FrameKind::kVoxels, static_cast<std::uint32_t>(look.chunks.size()), 0, voxels_payload(look)),
              "OK");
  lab.run(3);
  EXPECT_CODE(bert.ask(ReferenceRequest{"robot1", seen}), "STALE") << "the robot has not said where it is";
  say();
  const Json found = bert.ask(ReferenceRequest{"robot1", seen});
  ASSERT_TRUE(has_code(found, "OK"));
  EXPECT_LT(metres_off(transform_of(found["answer"]["T_robot_own"]), T_agent_base.inverse() * kT_left_right), kNear);
  ASSERT_TRUE(has_code(bert.ask(AlignAcceptRequest{found["answer"]["align"]}), "OK"));
  lab.run(1.5);
  EXPECT_LT(metres_off(transform_of(agent("quest")["T_map_agent"]), kT_left_right), kNear);

  // It believes to see the robot in quite another place.
  say();
  const Json wrong =
      bert.ask(ReferenceRequest{"robot1", pose_of(transform(3, 0, 0, 2) * kT_left_right.inverse() * T_agent_base)});
  EXPECT_CODE(wrong, "LOW_OVERLAP");

  EXPECT_CODE(bert.ask(ReferenceRequest{"nobody", seen}), "NO_ROBOT");
  EXPECT_CODE(bert.ask(ReferenceRequest{"quest", seen}), "BAD_REQUEST");
  EXPECT_CODE(ana.ask(ReferenceRequest{"robot1", seen}), "BAD_FRAME") << "ana is no agent";
  lab.bus->publish("in/robot5/pose", encode(AgentPose{"robot5", "odom", T_agent_base, lab.bus->now()}));
  lab.run(1.5);
  EXPECT_CODE(bert.ask(ReferenceRequest{"robot5", seen}), "NO_MODEL");
  bert.note(TrackingNotice{Tracking::kLost, {}, {}, {}});
  EXPECT_CODE(bert.ask(ReferenceRequest{"robot1", seen}), "TRACKING_LOST");
}

TEST(BridgeWithoutAlign, SaysSo) {
  Lab lab(Lab::kWithoutAlign);
  Client ana(lab);
  EXPECT_CODE(ana.hello(), "OK");
  EXPECT_CODE(ana.ask(AlignRequest{"robot1", {}, {}}), "UNAVAILABLE");
}

}  // namespace
}  // namespace concord::hmd
