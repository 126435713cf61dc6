// The headset as mapper, and agents.

#include "bridge/look_judge.hpp"
#include "bridge_test.hpp"

namespace concord::hmd {
namespace {

TEST_F(Bridge, VoxelsOfADeviceBecomeItsSubmap) {
  become_agent(ana, "hololens", false);
  const Json answer = ana.upload(FrameKind::kVoxels, 1, 0, voxels_payload(voxel_look(0.1, true)));
  EXPECT_CODE(answer, "OK");
  EXPECT_EQ(answer["answer"]["occupied"], 8);
  lab.run(3);
  const Json agents = ana.ask(AgentsRequest{})["answer"]["agents"];
  ASSERT_EQ(agents.size(), 1u);
  EXPECT_EQ(agents[0]["occupied"], 8) << agents;
  EXPECT_CODE(ana.upload(FrameKind::kVoxels, 1, 0, voxels_payload(voxel_look(0.1, true))), "DUP_SEQ");
  EXPECT_CODE(ana.upload(FrameKind::kVoxels, 1, 1, voxels_payload(voxel_look(0.05, true))), "RES_MISMATCH");
  EXPECT_CODE(ana.upload(FrameKind::kVoxels, 1, 1, voxels_payload(voxel_look(0.1, false))), "EMPTY");
  ana.note(TrackingNotice{Tracking::kLost, {}, {}, {}});
  EXPECT_CODE(ana.upload(FrameKind::kVoxels, 1, 1, voxels_payload(voxel_look(0.1, true))), "TRACKING_LOST");
  Client bert(lab);
  EXPECT_CODE(bert.hello(), "OK");
  EXPECT_CODE(bert.upload(FrameKind::kVoxels, 1, 1, voxels_payload(voxel_look(0.1, true))), "BAD_FRAME");
}

TEST_F(Bridge, AScannedMeshBecomesASubmapWithFreeSpace) {
  become_agent(ana, "quest", false);
  EXPECT_CODE(ana.ask(SendMapRequest{false}), "EMPTY");
  EXPECT_CODE(ana.upload(FrameKind::kMesh, 1, 0, mesh_payload(floor_look())), "OK");
  EXPECT_CODE(ana.ask(SendMapRequest{false}), "EMPTY") << "a cell needs two looks";
  EXPECT_CODE(ana.upload(FrameKind::kMesh, 0, 1, mesh_payload({floor_look().T_own_sensor, {}})), "OK");
  const Json sent = ana.ask(SendMapRequest{true});
  EXPECT_CODE(sent, "OK");
  EXPECT_EQ(sent["answer"]["occupied"], 21 * 21 - 0)
      << "a floor of 2 m in cells of 0.1 m, its far edges touch one more";
  EXPECT_GT(sent["answer"]["free"].get<int>(), 1000);
  EXPECT_CODE(ana.upload(FrameKind::kMesh, 1, 0, mesh_payload(floor_look())), "OK")
      << "after the final one, sequences begin anew";
  EXPECT_CODE(ana.upload(FrameKind::kMesh, 1, 0, mesh_payload(floor_look())), "DUP_SEQ");
}

TEST_F(Working, AResetEndsWhatAnAgentMapped) {
  EXPECT_CODE(ana.ask(ResetRequest{"nobody"}), "NO_AGENT");
  EXPECT_GT(lab.bridge->world().map().map().brick_count(), 0u);
  EXPECT_CODE(ana.ask(ResetRequest{"robot1"}), "OK");
  lab.run(2);
  EXPECT_EQ(lab.bridge->world().map().map().brick_count(), 0u);
}

TEST_F(Working, ARemovedAgentIsGoneWithItsMap) {
  EXPECT_CODE(ana.ask(RemoveRequest{"nobody"}), "NO_AGENT");
  lab.stop_robot();
  EXPECT_CODE(ana.ask(RemoveRequest{"robot1"}), "OK");
  lab.run(2);
  EXPECT_TRUE(ana.ask(AgentsRequest{})["answer"]["agents"].empty());
  EXPECT_EQ(lab.bridge->world().map().map().brick_count(), 0u);
}

TEST_F(Bridge, LooksHaveARate) {
  become_agent(ana, "quest", false);
  int taken = 0;
  for (int i = 0; i < 60; ++i) {
    const Json answer = ana.upload(FrameKind::kMesh, 0, taken, mesh_payload({floor_look().T_own_sensor, {}}));
    if (code_of_answer(answer) == "OK") {
      ++taken;
    } else {
      EXPECT_CODE(answer, "RATE");
    }
  }
  EXPECT_GE(taken, 20);
  EXPECT_LT(taken, 30);
}

TEST_F(Bridge, LooksAreJudgedBesideTheLoopInOrderAndFewMayWait) {
  become_agent(ana, "quest", false);
  const std::int64_t first = ana.last_id() + 1;
  for (std::int64_t i = 0; i < 3; ++i) {
    const FrameHead head{
        .kind = FrameKind::kMesh, .stream = static_cast<std::uint32_t>(ana.next_id()), .count = 1, .revision = i};
    lab.bridge->hub().binary(ana.connection, make_frame(head, mesh_payload(floor_look())), lab.bus->now());
  }
  ana.read();
  EXPECT_FALSE(ana.answers.contains(first)) << "whoever sends it does not wait for it within the loop";
  EXPECT_CODE(ana.answers[first + 2], "RATE");
  lab.run(1);
  ana.read();
  EXPECT_CODE(ana.answers[first], "OK");
  EXPECT_CODE(ana.answers[first + 1], "OK");
  EXPECT_EQ(ana.answers[first]["answer"]["occupied"], 0);
  EXPECT_GT(ana.answers[first + 1]["answer"]["occupied"], 0) << "in the order in which they came";
  EXPECT_CODE(ana.upload(FrameKind::kMesh, 1, 2, mesh_payload(floor_look())), "OK") << "what was refused is sent again";
}

TEST_F(Bridge, APayloadThatDoesNotInflateIsRefusedWithoutTheOthersWaiting) {
  become_agent(ana, "quest", false);
  Bytes frame = make_frame({.kind = FrameKind::kMesh, .stream = static_cast<std::uint32_t>(ana.next_id()), .count = 1},
                           Bytes(1000, 0));
  frame.back() ^= 0xFF;
  lab.bridge->hub().binary(ana.connection, frame, lab.bus->now());
  lab.run(0.1);
  ana.read();
  EXPECT_CODE(ana.answers[ana.last_id()], "BAD_MESSAGE");
  const VoxelLook many{0.1, 0.9, 0.2, Transform::Identity(), std::vector<VoxelChunk>(4097)};
  EXPECT_CODE(ana.upload(FrameKind::kVoxels, 4097, 0, voxels_payload(many)), "TOO_LARGE");
}

TEST(LookJudge, HandsOverALargeLookInTurns) {
  LockstepBus bus(Lab::kStart);
  LookJudge judge(bus, std::launch::deferred);
  VoxelLook look{0.1, 0.9, 0.2, Transform::Identity(), {}};
  for (int i = 0; i < 1000; ++i) {
    VoxelChunk& chunk = look.chunks.emplace_back(VoxelChunk{{i, 0, 0}, {}, {}});
    for (std::size_t part = 0; part < 8; ++part) {
      const auto cell = (part & 1) * 8 + (part >> 1 & 1) * 8 * 16 + (part >> 2) * 8 * 256;
      chunk.occupied[cell / 8] = 1;
    }
  }
  const Bytes bytes = make_frame({.kind = FrameKind::kVoxels, .stream = 1, .count = 1000}, voxels_payload(look));
  std::size_t bricks = 0, most = 0, since = 0;
  std::int64_t occupied = 0;
  ASSERT_TRUE(judge.offer({"quest", std::make_shared<RoomMapper>(0.1), false, read_packed(bytes).value(),
                           [&](BrickIndex, Brick) { ++since; },
                           [&](const Judged& judged) {
                             EXPECT_TRUE(judged.taken);
                             occupied = judged.occupied;
                           }}));
  for (int i = 0; i < 20 && occupied == 0; ++i) {
    bus.advance_to(bus.now() + 5'000);
    most = std::max(most, since);
    bricks += std::exchange(since, 0);
  }
  EXPECT_EQ(occupied, 8000);
  EXPECT_EQ(bricks, 8000u);
  EXPECT_EQ(most, LookJudge::kBricksOfATurn);
}

TEST(OwnMaps, OverTheBudgetALookIsRefusedAndNobodyLosesTheirMap) {
  Lab lab;
  lab.map_limits.bytes = 2'000;  // a brick's
  lab.restart_bridge();
  Client ana(lab), bert(lab);
  EXPECT_CODE(ana.hello("quest"), "OK");
  EXPECT_CODE(bert.hello("pico"), "OK");
  const Bytes look = voxels_payload(voxel_look(0.1, true));
  EXPECT_CODE(ana.upload(FrameKind::kVoxels, 1, 0, look), "OK");
  EXPECT_CODE(bert.upload(FrameKind::kVoxels, 1, 0, look), "TOO_LARGE");
  EXPECT_CODE(ana.upload(FrameKind::kVoxels, 1, 1, look), "TOO_LARGE");
  EXPECT_CODE(ana.ask(SendMapRequest{false}), "OK") << "what she has scanned is there";
  ana.lose();
  EXPECT_CODE(bert.upload(FrameKind::kVoxels, 1, 0, look), "TOO_LARGE") << "she may come back";
  for (int i = 0; i < 13; ++i) lab.run(10), bert.note(CreditNotice{1});
  EXPECT_CODE(bert.upload(FrameKind::kVoxels, 1, 0, look), "OK") << "what nobody speaks for makes room";
}

TEST(OwnMaps, OneIdentityHoldsAFewAgents) {
  Lab lab;
  lab.map_limits.agents_of_one = 2;
  lab.restart_bridge();
  Client first(lab), second(lab), third(lab);
  EXPECT_CODE(first.hello("quest1"), "OK");
  EXPECT_CODE(second.hello("quest2"), "OK");
  EXPECT_CODE(third.hello("quest3"), "OK");
  const Bytes look = voxels_payload(voxel_look(0.1, true));
  EXPECT_CODE(first.upload(FrameKind::kVoxels, 1, 0, look), "OK");
  EXPECT_CODE(second.upload(FrameKind::kVoxels, 1, 0, look), "OK");
  EXPECT_CODE(third.upload(FrameKind::kVoxels, 1, 0, look), "BUSY");
  EXPECT_CODE(first.upload(FrameKind::kVoxels, 1, 1, look), "OK");
}

TEST_F(Bridge, AnEmptyLookAfterARestartLeavesTheSubmapAlone) {
  become_agent(ana, "quest", false);
  EXPECT_CODE(ana.upload(FrameKind::kVoxels, 1, 0, voxels_payload(voxel_look(0.1, true))), "OK");
  lab.run(3);
  lab.restart_bridge();
  Client back(lab);
  EXPECT_CODE(back.hello("quest"), "OK");
  EXPECT_CODE(back.upload(FrameKind::kMesh, 0, 0, mesh_payload({floor_look().T_own_sensor, {}})), "OK");
  lab.run(4);
  const Json agents = back.ask(AgentsRequest{})["answer"]["agents"];
  ASSERT_EQ(agents.size(), 1u);
  EXPECT_EQ(agents[0]["occupied"], 8) << "nothing was scanned anew that could take its place";
}

TEST_F(Bridge, APartOfARoomAfterARestartDoesNotTakeThePlaceOfTheWhole) {
  become_agent(ana, "quest", false);
  EXPECT_CODE(ana.upload(FrameKind::kVoxels, 1, 0, voxels_payload(voxel_look(0.1, true))), "OK");
  lab.run(3);
  lab.restart_bridge();
  Client back(lab);
  EXPECT_CODE(back.hello("quest"), "OK");
  EXPECT_CODE(back.upload(FrameKind::kMesh, 1, 2, mesh_payload(floor_look())), "BAD_FRAME");
  lab.run(4);
  const Json agents = back.ask(AgentsRequest{})["answer"]["agents"];
  ASSERT_EQ(agents.size(), 1u);
  EXPECT_EQ(agents[0]["occupied"], 8);
  EXPECT_CODE(back.upload(FrameKind::kVoxels, 1, 0, voxels_payload(voxel_look(0.1, true))), "OK") << "the whole, anew";
}

TEST_F(Bridge, AfterAResetTheFrameIsOver) {
  become_agent(ana, "quest", false);
  EXPECT_CODE(ana.upload(FrameKind::kMesh, 1, 0, mesh_payload(floor_look())), "OK");
  EXPECT_CODE(ana.upload(FrameKind::kMesh, 1, 1, mesh_payload(floor_look())), "OK");
  lab.run(2);
  EXPECT_CODE(ana.ask(ResetRequest{"quest"}), "OK");
  lab.run(1);
  EXPECT_CODE(ana.upload(FrameKind::kMesh, 1, 2, mesh_payload(floor_look())), "BAD_FRAME");
  ana.note(TrackingNotice{Tracking::kOk, "local2", kHere, {}});
  EXPECT_CODE(ana.upload(FrameKind::kMesh, 1, 0, mesh_payload(floor_look())), "OK");
}

TEST_F(Working, AgentsAreListed) {
  const Json agents = ana.ask(AgentsRequest{})["answer"]["agents"];
  ASSERT_EQ(agents.size(), 1u);
  EXPECT_EQ(agents[0]["agent"], "robot1");
  EXPECT_TRUE(agents[0]["aligned"]);
  EXPECT_CODE(ana.ask(WeightRequest{"robot1", 7}), "OK");
  EXPECT_CODE(ana.ask(WeightRequest{"nobody", 7}), "NO_AGENT");
  EXPECT_CODE(ana.ask(WeightRequest{"robot1", 0}), "BAD_REQUEST");
}

TEST_F(Working, AMinimapComesAsPointsBeforeItsAnswer) {
  const Json answer = ana.ask(MinimapRequest{"robot1", 0.5});
  EXPECT_CODE(answer, "OK");
  ASSERT_EQ(ana.frames.size(), 1u);
  EXPECT_EQ(ana.frames[0].head.kind, FrameKind::kPoints);
  EXPECT_EQ(ana.frames[0].head.stream, ana.last_id());
  EXPECT_EQ(ana.frames[0].head.count, answer["answer"]["points"]);
  EXPECT_EQ(answer["answer"]["points"], 13 * 13);
  EXPECT_CODE(ana.ask(MinimapRequest{"nobody", 0.5}), "NO_AGENT");
  lab.bus->publish("in/cart/pose", encode(AgentPose{"cart", "odom", Transform::Identity(), lab.bus->now()}));
  lab.run(1.5);
  EXPECT_CODE(ana.ask(MinimapRequest{"cart", 0.5}), "NO_MAP") << "it sends nothing but where it is";
  EXPECT_CODE(ana.ask(MinimapRequest{"robot1", 0.01}), "RES_MISMATCH");
}

TEST_F(Working, APlacementCanBeTakenBack) {
  EXPECT_CODE(ana.ask(AlignUndoRequest{"robot1"}), "EXPIRED") << "it had no place before";
  EXPECT_CODE(ana.ask(PlaceRequest{"robot1", Pose{{0, 0, 1}, {0, 0, 0, 1}}}), "OK");
  lab.run(1.5);
  const Json back = ana.ask(AlignUndoRequest{"robot1"});
  EXPECT_CODE(back, "OK");
  lab.run(1.5);
  EXPECT_EQ(ana.ask(AgentsRequest{})["answer"]["agents"][0]["T_map_agent"]["position"], Json({0.0, 0.0, 0.0}));
  EXPECT_CODE(ana.ask(AlignUndoRequest{"robot1"}), "EXPIRED");
  EXPECT_CODE(ana.ask(PlaceRequest{"nobody", kHere}), "NO_AGENT");
  EXPECT_CODE(ana.ask(PlaceRequest{"robot1", Pose{{9000, 0, 0}, {0, 0, 0, 1}}}), "OUT_OF_BOUNDS");
}

TEST_F(Working, UnalignedHeadsetsCannotWorkInTheirFrame) {
  Client bert(lab);
  become_agent(bert, "quest", false);
  EXPECT_CODE(bert.ask(ViewRequest{Layer::kMap, {}, Frame::kOwn, {0, 0, 0}, {5}, {}}), "UNALIGNED");
  EXPECT_CODE(bert.ask(EditRequest{EditOp::kAdd, Frame::kOwn, box(1, 1, 0.2, 1.2, 1.2, 0.4), {}, {}}), "UNALIGNED");
}

TEST_F(Working, ConflictsAreListed) {
  Client bert(lab);
  become_agent(bert, "quest", true);
  EXPECT_CODE(bert.upload(FrameKind::kVoxels, 1, 0, voxels_payload(voxel_look(0.1, true))), "OK");
  lab.run(4);
  EXPECT_CODE(bert.ask(PlaceRequest{"quest", Pose{{1, 1, 0}, {0, 0, 0, 1}}}), "OK");
  lab.run(3);
  const Json answer = ana.ask(ConflictsRequest{10});
  EXPECT_CODE(answer, "OK");
  EXPECT_EQ(answer["answer"]["voxels_in_all"], 8) << answer;
  EXPECT_CODE(ana.ask(ConflictsRequest{0}), "BAD_REQUEST");
}

}  // namespace
}  // namespace concord::hmd
