// Every row of what a headset can ask: one test for the answer, one for each way it can fail.

#include <gtest/gtest.h>

#include <fstream>

#include "lab.hpp"

namespace concord::hmd {
namespace {

/// For EXPECT_CODE: what was answered, in whole, when it was not what was expected.
testing::AssertionResult has_code(const Json& answer, const std::string& code) {
  if (code_of_answer(answer) == code) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "not " << code << ": " << answer.dump();
}
#define EXPECT_CODE(answer, code) EXPECT_TRUE(has_code((answer), (code)))

const Pose kHere{{0, 0, 0}, {0, 0, 0, 1}};

Shape box(double x0, double y0, double z0, double x1, double y1, double z1) { return Box{{x0, y0, z0}, {x1, y1, z1}}; }
EditRequest add(const Shape& shape) { return {EditOp::kAdd, Frame::kMap, shape, {}, {}}; }

/// A lab in which robot1 has mapped a hall and lies in the map, and somebody who works there.
class Bridge : public testing::Test {
 protected:
  void place_robot() {
    lab.robot_maps();
    EXPECT_CODE(ana.ask(PlaceRequest{"robot1", kHere}), "OK");
    lab.run(2.5);
    lab.robot_at(1, 1);
    lab.run(1.5);
  }
  /// ana as an agent that the stack knows, and that lies in the map.
  void become_agent(Client& client, const std::string& agent, bool placed) {
    EXPECT_CODE(client.hello(agent), "OK");
    client.note(TrackingNotice{Tracking::kOk, "local1", kHere, {}});
    lab.run(1.5);
    if (placed) {
      EXPECT_CODE(client.ask(PlaceRequest{agent, Pose{{1, 0, 0}, {0, 0, 0, 1}}}), "OK");
    }
    lab.run(1.5);
  }

  Lab lab;
  Client ana{lab};
};

class Working : public Bridge {
 protected:
  void SetUp() override {
    ASSERT_EQ(code_of_answer(ana.hello()), "OK");
    place_robot();
  }
};

TEST_F(Bridge, HelloAnswersWithRoleAndLimits) {
  const Json answer = ana.hello()["answer"];
  EXPECT_EQ(answer["role"], "robot");
  EXPECT_EQ(answer["resolution"], 0.1);
  EXPECT_FALSE(answer["session"].get<std::string>().empty());
  EXPECT_TRUE(ana.events.contains("agents"));
}

TEST_F(Bridge, HelloRefusesAnotherVersion) {
  HelloRequest hello;
  hello.version = "hmd.v0";
  EXPECT_CODE(ana.ask(hello), "VERSION");
  EXPECT_TRUE(lab.bridge->hub().closing(ana.connection));
}

TEST_F(Bridge, FromElsewhereATicketIsNeededAndOpensOnce) {
  HelloRequest hello;
  hello.version = kProtocol;
  Client nobody(lab, {"10.0.0.7", false});
  EXPECT_CODE(nobody.ask(hello), "BAD_TOKEN");
  hello.ticket = lab.gate->issue({"bert", Role::kView}, lab.bus->now());
  Client bert(lab, {"10.0.0.7", false});
  const Json answer = bert.ask(hello);
  EXPECT_CODE(answer, "OK");
  EXPECT_EQ(answer["answer"]["name"], "bert");
  Client again(lab, {"10.0.0.7", false});
  EXPECT_CODE(again.ask(hello), "BAD_TOKEN");
}

TEST_F(Bridge, WhoOnlyLooksCannotChange) {
  HelloRequest hello;
  hello.version = kProtocol;
  hello.ticket = lab.gate->issue({"bert", Role::kView}, lab.bus->now());
  Client bert(lab, {"10.0.0.7", false});
  EXPECT_CODE(bert.ask(hello), "OK");
  EXPECT_CODE(bert.ask(AgentsRequest{}), "OK");
  EXPECT_CODE(bert.ask(add(box(1, 1, 0.2, 1.5, 1.5, 0.5))), "DENIED");
  hello.ticket = lab.gate->issue({"cleo", Role::kEdit}, lab.bus->now());
  Client cleo(lab, {"10.0.0.7", false});
  EXPECT_CODE(cleo.ask(hello), "OK");
  EXPECT_CODE(cleo.ask(GoalRequest{"robot1", Frame::kMap, kHere}), "DENIED");
}

TEST_F(Bridge, WithoutHelloNothingGoes) {
  lab.bridge->hub().text(ana.connection, request_text(1, AgentsRequest{}), lab.bus->now());
  ana.read();
  EXPECT_EQ(lab.bridge->hub().closing(ana.connection)->code, 1002);
  Client idle(lab);
  lab.run(6);
  EXPECT_EQ(lab.bridge->hub().closing(idle.connection)->code, 1008) << "no hello within 5 s";
}

TEST_F(Bridge, ALostSessionGoesOnAndNothingIsDoneTwice) {
  const Json first = ana.hello()["answer"];
  place_robot();
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {1000}, {}}), "OK");
  lab.run(0.5);
  ana.read();
  const Json complete = ana.events["complete"];
  const std::string edit = request_text(ana.next_id(), add(box(1, 1, 0.2, 1.5, 1.5, 0.5)));
  const std::int64_t id = ana.last_id();
  lab.bridge->hub().text(ana.connection, edit, lab.bus->now());
  ana.lose();  // before the answer
  lab.run(1);

  Client back(lab);
  HelloRequest hello;
  hello.version = kProtocol;
  hello.name = "ana";
  hello.resume = Resume{first["session"], complete["epoch"], complete["revision"]};
  const Json resumed = back.ask_text(id + 1, request_text(id + 1, hello));
  ASSERT_TRUE(resumed["answer"]["resumed"].get<bool>()) << resumed;
  EXPECT_CODE(back.ask_text(id, edit), "OK");
  const Json history = back.ask_text(id + 2, request_text(id + 2, HistoryRequest{{}, {}, OperationKind::kAdd, {}, 100}));
  EXPECT_EQ(history["answer"]["operations"].size(), 1u) << history;
  back.note(CreditNotice{1'000'000});
  const Json view = back.ask_text(id + 3, request_text(id + 3, ViewRequest{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {1000}, {}}));
  EXPECT_CODE(view, "OK");
  lab.run(0.3);
  back.read();
  ASSERT_EQ(back.frames.size(), 1u) << "just the block that changed";
  EXPECT_FALSE(back.frames[0].head.whole);
}

TEST_F(Bridge, AStrangerCannotTakeUpASession) {
  const Json first = ana.hello()["answer"];
  HelloRequest hello;
  hello.version = kProtocol;
  hello.name = "eve";
  hello.resume = Resume{first["session"], "", 0};
  Client eve(lab);
  EXPECT_FALSE(eve.ask(hello)["answer"]["resumed"].get<bool>());
}

TEST_F(Bridge, ClockTellsWhenItArrived) {
  EXPECT_CODE(ana.hello(), "OK");
  const Json answer = ana.ask(ClockRequest{12.5})["answer"];
  EXPECT_EQ(answer["t0"], 12.5);
  EXPECT_GE(answer["t2"], answer["t1"]);
}

TEST_F(Bridge, IdsCountUpAndMalformedRequestsReachTheirAsker) {
  EXPECT_CODE(ana.hello(), "OK");
  EXPECT_CODE(ana.ask_text(5, R"({"id":5,"request":"agents","body":{}})"), "OK");
  EXPECT_CODE(ana.ask_text(3, R"({"id":3,"request":"agents","body":{}})"), "BAD_REQUEST");
  EXPECT_CODE(ana.ask_text(6, R"({"id":6,"request":"agents","body":{"more":1}})"), "BAD_MESSAGE");
  EXPECT_CODE(ana.ask_text(7, R"({"id":7,"request":"agents","body":{}})"), "OK");
}

TEST_F(Bridge, RequestsBeyondTheRateAreRefusedAndAFloodIsCutOff) {
  EXPECT_CODE(ana.hello(), "OK");
  int rate = 0;
  for (std::int64_t id = 10; id < 400; ++id) lab.bridge->hub().text(ana.connection, request_text(id, AgentsRequest{}), lab.bus->now());
  ana.read();
  for (const auto& [id, answer] : ana.answers) rate += code_of_answer(answer) == "RATE" ? 1 : 0;
  EXPECT_GT(rate, 50);
  EXPECT_EQ(lab.bridge->hub().closing(ana.connection)->code, 1008);
}

TEST_F(Bridge, WhileTrackingIsLostTheOwnFrameIsRefused) {
  become_agent(ana, "quest", true);
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kOwn, {0, 0, 0}, {10}, {}}), "OK");
  ana.note(TrackingNotice{Tracking::kLost, {}, {}, {}});
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kOwn, {0, 0, 0}, {10}, {}}), "TRACKING_LOST");
  ana.note(TrackingNotice{Tracking::kOk, "local1", kHere, {}});
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kOwn, {0, 0, 0}, {10}, {}}), "OK");
  ana.note(TrackingNotice{Tracking::kOk, "local2", kHere, {}});
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kOwn, {0, 0, 0}, {10}, {}}), "UNALIGNED");
}

TEST_F(Bridge, OthersSeeWhereOneIs) {
  become_agent(ana, "quest", true);
  Client bert(lab);
  EXPECT_CODE(bert.hello(), "OK");
  ana.note(TrackingNotice{Tracking::kOk, "local1", Pose{{0, 2, 1}, {0, 0, 0, 1}}, std::array<double, 3>{0, 0, 0}});
  lab.run(0.3);
  bert.read();
  const Json people = bert.events["people"]["people"];
  ASSERT_EQ(people.size(), 1u);
  EXPECT_EQ(people[0]["T_map_head"]["position"], Json({1.0, 2.0, 1.0}));
  EXPECT_EQ(people[0]["p_map_pointer"], Json({1.0, 0.0, 0.0}));
}

VoxelLook voxel_look(double resolution, bool any) {
  VoxelLook look{resolution, 0.9, 0.2, Transform::Identity(), {VoxelChunk{{0, 0, 0}, {}, {}}}};
  if (any) look.chunks[0].occupied[0] = 0xFF;
  return look;
}

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

MeshLook floor_look() {
  MeshLook look;
  look.T_own_sensor.translation() = Eigen::Vector3d(0, 0, 1.5);
  look.parts.push_back({1, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}});
  return look;
}

TEST_F(Bridge, AScannedMeshBecomesASubmapWithFreeSpace) {
  become_agent(ana, "quest", false);
  EXPECT_CODE(ana.ask(SendMapRequest{false}), "EMPTY");
  EXPECT_CODE(ana.upload(FrameKind::kMesh, 1, 0, mesh_payload(floor_look())), "OK");
  EXPECT_CODE(ana.ask(SendMapRequest{false}), "EMPTY") << "a cell needs two looks";
  EXPECT_CODE(ana.upload(FrameKind::kMesh, 0, 1, mesh_payload({floor_look().T_own_sensor, {}})), "OK");
  const Json sent = ana.ask(SendMapRequest{true});
  EXPECT_CODE(sent, "OK");
  EXPECT_EQ(sent["answer"]["occupied"], 21 * 21 - 0) << "a floor of 2 m in cells of 0.1 m, its far edges touch one more";
  EXPECT_GT(sent["answer"]["free"].get<int>(), 1000);
  EXPECT_CODE(ana.upload(FrameKind::kMesh, 1, 0, mesh_payload(floor_look())), "OK") << "after the final one, sequences begin anew";
  EXPECT_CODE(ana.upload(FrameKind::kMesh, 1, 0, mesh_payload(floor_look())), "DUP_SEQ");
}

TEST_F(Working, ResetAndRemoveEndAnAgent) {
  EXPECT_CODE(ana.ask(ResetRequest{"nobody"}), "NO_AGENT");
  EXPECT_CODE(ana.ask(ResetRequest{"robot1"}), "OK");
  EXPECT_CODE(ana.ask(RemoveRequest{"nobody"}), "NO_AGENT");
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
  EXPECT_CODE(ana.ask(MinimapRequest{"robot1", 0.01}), "RES_MISMATCH");
}

TEST_F(Working, WhatAlignsAndLabelsIsNotHereYet) {
  EXPECT_CODE(ana.ask(AlignRequest{"robot1", {}, {}}), "UNAVAILABLE");
  EXPECT_CODE(ana.ask(AssetsRequest{}), "UNAVAILABLE");
  EXPECT_CODE(ana.ask(LabelsRequest{}), "UNAVAILABLE");
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

TEST_F(Working, AViewComesWholeThenJustWhatChanges) {
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {100}, {}}), "OK");
  lab.run(0.2);
  ana.read();
  int voxels = 0;
  for (const BinaryFrame& frame : ana.frames) {
    const BlockContent content = read_block(frame).value();
    for (const ChunkBits& bits : content.chunks) {
      for (const std::uint8_t byte : bits) voxels += std::popcount(byte);
    }
  }
  EXPECT_EQ(voxels, 64 * 64);
  EXPECT_EQ(ana.events["complete"]["stream"], 0);
  ana.frames.clear();
  EXPECT_CODE(ana.ask(add(Voxels{0.1, {{{20, 20, 3, 20, 20, 3}}}})), "OK");
  lab.run(0.5);
  ana.read();
  ASSERT_EQ(ana.frames.size(), 1u);
  EXPECT_EQ(read_block(ana.frames[0])->chunks.size(), 1u);
  EXPECT_LT(ana.frames[0].payload.size(), 600u);
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kAgent, "robot1", Frame::kMap, {0, 0, 0}, {0, 0, 100}, {}}), "OK");
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kAgent, "nobody", Frame::kMap, {0, 0, 0}, {100}, {}}), "NO_AGENT");
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {5, 2}, {}}), "BAD_REQUEST");
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kMap, {}, Frame::kOwn, {0, 0, 0}, {5}, {}}), "BAD_FRAME");
  EXPECT_CODE(ana.ask(ViewCloseRequest{0}), "OK");
  EXPECT_CODE(ana.ask(ViewCloseRequest{0}), "NOT_FOUND");
}

TEST_F(Working, WithoutCreditNoBlockComes) {
  Client bert(lab);
  HelloRequest hello;
  hello.version = kProtocol;
  EXPECT_CODE(bert.ask(hello), "OK");
  EXPECT_CODE(bert.ask(ViewRequest{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {100}, {}}), "OK");
  lab.run(1);
  bert.read();
  EXPECT_TRUE(bert.frames.empty());
  bert.note(CreditNotice{400});
  EXPECT_LE(bert.bytes, 400);
  bert.note(CreditNotice{1'000'000});
  EXPECT_FALSE(bert.frames.empty());
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

TEST_F(Working, EditsAnswerWithTheirIdAndCanBeUndoneAndRedone) {
  const Json answer = ana.ask(add(box(1, 1, 0.2, 1.5, 1.5, 0.5)));
  EXPECT_CODE(answer, "OK");
  EXPECT_EQ(answer["answer"]["voxels"], 5 * 5 * 3);
  const std::string edit = answer["answer"]["edit"];
  EXPECT_CODE(ana.ask(UndoRequest{edit}), "OK");
  EXPECT_CODE(ana.ask(UndoRequest{edit}), "CONFLICT");
  EXPECT_CODE(ana.ask(RedoRequest{edit}), "OK");
  EXPECT_CODE(ana.ask(RedoRequest{edit}), "CONFLICT");
  EXPECT_CODE(ana.ask(UndoRequest{"no such"}), "NOT_FOUND");
  EditRequest move{EditOp::kMove, Frame::kMap, box(1, 1, 0.2, 1.5, 1.5, 0.5), std::array<double, 3>{1, 0, 0}, {}};
  EXPECT_EQ(ana.ask(move)["answer"]["voxels"], 2 * 75);
  EXPECT_CODE(ana.ask(EditRequest{EditOp::kDelete, Frame::kMap, box(2, 1, 0.2, 2.5, 1.5, 0.5), {}, {}}), "OK");
}

TEST_F(Working, EditsAreRefusedForTheirReasons) {
  const Shape wall = box(1, 1, 0.2, 1.5, 1.5, 0.5);
  EditRequest stale = add(wall);
  stale.base_revision = ana.ask(add(wall))["answer"]["revision"].get<std::int64_t>() - 1;
  EXPECT_CODE(ana.ask(stale), "STALE_REV");
  EXPECT_CODE(ana.ask(add(box(9000, 0, 0, 9001, 1, 1))), "OUT_OF_BOUNDS");
  EXPECT_CODE(ana.ask(add(box(2, 2, 2, 1, 1, 1))), "BAD_SHAPE");
  EXPECT_CODE(ana.ask(add(box(0, 0, 0, 100, 100, 100))), "TOO_LARGE");
  EXPECT_CODE(ana.ask(add(Voxels{0.05, {{{0, 0, 0, 1, 1, 1}}}})), "RES_MISMATCH");
  EditRequest move{EditOp::kMove, Frame::kMap, box(3, 3, 0.2, 3.5, 3.5, 0.5), std::array<double, 3>{1, 0, 0}, {}};
  EXPECT_CODE(ana.ask(move), "EMPTY");
  move.shape = wall;
  move.move = std::array<double, 3>{0, 0, -0.3};
  EXPECT_CODE(ana.ask(move), "COLLISION");
  Client bert(lab);
  HelloRequest hello;
  hello.version = kProtocol;
  hello.name = "bert";
  EXPECT_CODE(bert.ask(hello), "OK");
  EXPECT_CODE(bert.ask(LeaseHoldRequest{"mine", Frame::kMap, Box{{3, 3, 0}, {4, 4, 1}}}), "OK");
  EXPECT_CODE(ana.ask(add(box(3.2, 3.2, 0.2, 3.4, 3.4, 0.4))), "LOCKED");
  EXPECT_CODE(ana.ask(LeaseHoldRequest{"hers", Frame::kMap, Box{{3, 3, 0}, {4, 4, 1}}}), "LOCKED");
  EXPECT_CODE(ana.ask(ZoneAddRequest{"z", ZoneKind::kNoGo, Frame::kMap, Box{{3, 3, 0}, {4, 4, 1}}}), "LOCKED");
  EXPECT_CODE(bert.ask(LeaseFreeRequest{"mine"}), "OK");
  EXPECT_CODE(ana.ask(add(box(3.2, 3.2, 0.2, 3.4, 3.4, 0.4))), "OK");
}

TEST_F(Working, ZonesAreAddedChangedAndDeleted) {
  const ZoneAddRequest zone{"dock", ZoneKind::kNoGo, Frame::kMap, Box{{3, 3, 0}, {4, 4, 1}}};
  const Json added = ana.ask(zone);
  EXPECT_CODE(added, "OK");
  EXPECT_CODE(ana.ask(zone), "EXISTS");
  lab.run(1);
  ana.read();
  EXPECT_EQ(ana.events["zones"]["zones"][0]["name"], "dock");
  EXPECT_CODE(ana.ask(ZoneAddRequest{"a/b", ZoneKind::kNoGo, Frame::kMap, zone.volume}), "BAD_NAME");
  EXPECT_CODE(ana.ask(ZoneAddRequest{"b", ZoneKind::kNoGo, Frame::kMap, Prism{{{0, 0}, {1, 1}}, 0, 1}}), "BAD_SHAPE");
  const std::int64_t revision = added["answer"]["revision"];
  EXPECT_CODE(ana.ask(ZoneChangeRequest{"dock", ZoneKind::kAllowContact, Frame::kMap, zone.volume, revision - 1}), "STALE_REV");
  EXPECT_CODE(ana.ask(ZoneChangeRequest{"dock", ZoneKind::kAllowContact, Frame::kMap, zone.volume, revision}), "OK");
  EXPECT_CODE(ana.ask(ZoneChangeRequest{"none", ZoneKind::kNoGo, Frame::kMap, zone.volume, {}}), "NOT_FOUND");
  EXPECT_CODE(ana.ask(ZoneDeleteRequest{"dock", {}}), "OK");
  EXPECT_CODE(ana.ask(ZoneDeleteRequest{"dock", {}}), "NOT_FOUND");
}

TEST_F(Working, ASceneGoesOutAndComesBack) {
  const Json got = ana.ask(SceneGetRequest{Frame::kMap, {3.2, 3.2, 0}, 20});
  EXPECT_CODE(got, "OK");
  EXPECT_EQ(got["answer"]["voxels"]["boxes"].size(), 1u) << "the floor";
  const std::int64_t revision = got["answer"]["revision"];
  SceneSendRequest scene{revision, Frame::kMap, {{EditOp::kAdd, box(1, 1, 0.2, 1.5, 1.5, 0.5)}, {EditOp::kDelete, box(1, 1, 0.2, 1.2, 1.2, 0.5)}},
                         {{"dock", ZoneKind::kNoGo, Box{{3, 3, 0}, {4, 4, 1}}}}};
  const Json sent = ana.ask(scene);
  EXPECT_CODE(sent, "OK");
  EXPECT_EQ(sent["answer"]["edits"].size(), 2u);
  EXPECT_EQ(sent["answer"]["zones"], 1);
  EXPECT_CODE(ana.ask(scene), "STALE_REV") << "others changed it since";
  EXPECT_CODE(ana.ask(SceneSendRequest{revision, Frame::kMap, {}, {}}), "EMPTY");
  EXPECT_CODE(ana.ask(SceneGetRequest{Frame::kMap, {0, 0, 0}, 21}), "BAD_REQUEST");
}

TEST_F(Working, ARobotThatWasSeenIsCorrected) {
  lab.robot_at(1, 1);
  lab.run(0.1);
  RobotCorrectRequest seen{"robot1", Frame::kMap, Pose{{2, 1, 0}, {0, 0, 0, 1}}, lab.bus->now() - 100'000, {}};
  const Json answer = ana.ask(seen);
  EXPECT_CODE(answer, "OK");
  lab.run(1.5);
  EXPECT_NEAR(ana.ask(AgentsRequest{})["answer"]["agents"][0]["T_map_agent"]["position"][0].get<double>(), 1, 1e-9);
  seen.utime = lab.bus->now() - 60'000'000;
  EXPECT_CODE(ana.ask(seen), "STALE_STAMP");
  seen.covariance = std::array<double, 6>{1, 0, 0, 0, 0, 0};
  EXPECT_CODE(ana.ask(seen), "REJECTED");
  EXPECT_CODE(ana.ask(RobotCorrectRequest{"nobody", Frame::kMap, kHere, lab.bus->now(), {}}), "NO_ROBOT");
}

TEST_F(Working, ARobotsPoseIsToldWhileItIsFresh) {
  lab.robot_at(1.5, 1);
  lab.run(0.2);
  const Json answer = ana.ask(RobotPoseRequest{"robot1"});
  EXPECT_CODE(answer, "OK");
  EXPECT_EQ(answer["answer"]["T_map_base"]["position"], Json({1.5, 1.0, 0.0}));
  EXPECT_CODE(ana.ask(RobotPoseRequest{"nobody"}), "NO_ROBOT");
  lab.run(2.5);
  EXPECT_CODE(ana.ask(RobotPoseRequest{"robot1"}), "STALE");
  ana.read();
  EXPECT_TRUE(ana.events["poses"]["poses"][0]["stale"].get<bool>());
}

TEST_F(Working, APathIsFollowedThroughItsChanges) {
  const Json none = ana.ask(PathRequest{"robot1", Frame::kMap, true});
  EXPECT_CODE(none, "OK");
  EXPECT_EQ(none["answer"]["path"]["status"], "NO_PATH");
  EXPECT_TRUE(none["answer"]["path"]["points"].empty()) << "a valid, empty path";
  EXPECT_CODE(ana.ask(PathRequest{"nobody", Frame::kMap, true}), "NO_ROBOT");
  const Json goal = ana.ask(GoalRequest{"robot1", Frame::kMap, Pose{{5, 1, 0}, {0, 0, 0, 1}}});
  EXPECT_CODE(goal, "OK");
  EXPECT_NEAR(goal["answer"]["path"]["length"].get<double>(), 4, 1e-6);
  EXPECT_GE(goal["answer"]["path"]["points"].size(), 17u) << "at most 0.25 m apart";
  EXPECT_GT(goal["answer"]["path"]["points"][8]["clearance"].get<double>(), 0.2);
  lab.run(0.3);
  ana.read();
  EXPECT_EQ(ana.events["path"]["robot"], "robot1");
  EXPECT_CODE(ana.ask(add(box(3, 0, 0.2, 3.2, 3, 0.6))), "OK");
  lab.run(2);
  ana.read();
  EXPECT_GT(ana.events["path"]["path"]["length"].get<double>(), 5.0) << "around the wall";
  EXPECT_CODE(ana.ask(PathRequest{"robot1", Frame::kMap, false}), "OK");
}

TEST_F(Working, GoalsThatCannotBeReachedAreRefused) {
  EXPECT_CODE(ana.ask(GoalRequest{"robot1", Frame::kMap, Pose{{50, 1, 0}, {0, 0, 0, 1}}}), "UNREACHABLE");
  EXPECT_CODE(ana.ask(GoalRequest{"nobody", Frame::kMap, kHere}), "NO_ROBOT");
  EXPECT_CODE(ana.ask(PlanRequest{"robot1", Frame::kMap, {}, {5, 1, 0}}), "OK");
  EXPECT_CODE(ana.ask(PlanRequest{"robot1", Frame::kMap, {}, {50, 1, 0}}), "UNREACHABLE");
}

TEST_F(Working, AVirtualObstacleForcesAnotherPath) {
  EXPECT_CODE(ana.ask(GoalRequest{"robot1", Frame::kMap, Pose{{5, 1, 0}, {0, 0, 0, 1}}}), "OK");
  lab.run(1.5);
  const Json added = ana.ask(ObstacleAddRequest{Frame::kMap, Box{{3, 0, 0.1}, {3.2, 3, 0.8}}, {}});
  ASSERT_EQ(code_of_answer(added), "OK") << added;
  ASSERT_EQ(added["answer"]["paths"].size(), 1u) << added;
  EXPECT_TRUE(added["answer"]["paths"][0]["replanned"].get<bool>()) << added;
  EXPECT_EQ(added["answer"]["paths"][0]["status"], "OK");
  EXPECT_CODE(ana.ask(ObstacleAddRequest{Frame::kMap, Box{{0.9, 0.9, 0.1}, {1.1, 1.1, 0.8}}, {}}), "ROBOT_INSIDE");
  const Json cut = ana.ask(ObstacleAddRequest{Frame::kMap, Box{{3, -1, 0.1}, {3.2, 7, 0.8}}, {}});
  EXPECT_CODE(cut, "NO_PATH");
  lab.run(1.5);
  EXPECT_EQ(ana.ask(PathRequest{"robot1", Frame::kMap, false})["answer"]["path"]["status"], "OK") << "it was taken back";
  const std::string obstacle = added["answer"]["obstacle"];
  EXPECT_CODE(ana.ask(ObstacleRemoveRequest{obstacle}), "OK");
  EXPECT_CODE(ana.ask(ObstacleRemoveRequest{obstacle}), "CONFLICT");
  EXPECT_CODE(ana.ask(ObstacleRemoveRequest{"none"}), "NOT_FOUND");
}

TEST_F(Working, TheGridBetweenTwoHeightsComesAsCells) {
  const Json answer = ana.ask(GridRequest{{0.1, 0.8}});
  EXPECT_CODE(answer, "OK");
  EXPECT_EQ(answer["answer"]["free"], 64 * 64);
  EXPECT_EQ(answer["answer"]["occupied"], 0);
  ASSERT_EQ(ana.frames.size(), 1u);
  EXPECT_EQ(ana.frames[0].head.kind, FrameKind::kCells);
  EXPECT_EQ(ana.ask(GridRequest{{-0.1, 0.1}})["answer"]["occupied"], 64 * 64);
  EXPECT_CODE(ana.ask(GridRequest{{5, 6}}), "NO_MAP");
  EXPECT_CODE(ana.ask(GridRequest{{1, 1}}), "OUT_OF_BOUNDS");
}

TEST_F(Working, MapsAreSavedListedAndLoaded) {
  const SaveRequest save{"hall", {Format::kBt, Format::kConcord}, false};
  lab.run(3);
  const Json saved = ana.ask(save);
  EXPECT_CODE(saved, "OK");
  EXPECT_EQ(saved["answer"]["files"].size(), 2u);
  EXPECT_CODE(ana.ask(save), "EXISTS");
  EXPECT_EQ(ana.ask(MapsRequest{})["answer"]["maps"].size(), 2u);
  const std::int64_t id = ana.next_id();
  const Json climb = {{"id", id}, {"request", "save"}, {"body", {{"map", "../x"}, {"formats", {"bt"}}, {"overwrite", false}}}};
  EXPECT_CODE(ana.ask_text(id, climb.dump()), "BAD_MESSAGE") << "no name is a path";
  EXPECT_CODE(ana.ask(LoadRequest{"hall", Format::kBt, "copy"}), "OK");
  EXPECT_CODE(ana.ask(LoadRequest{"hall", Format::kBt, "copy"}), "EXISTS");
  EXPECT_CODE(ana.ask(LoadRequest{"none", {}, {}}), "NOT_FOUND");
  std::ofstream(lab.site.state / "maps" / "broken.bt") << "no map";
  EXPECT_CODE(ana.ask(LoadRequest{"broken", {}, {}}), "CORRUPT");
}

TEST(BridgeAlone, WhatNobodyAnswersIsATimeout) {
  Lab lab(Lab::kWithoutMerge);
  Client ana(lab);
  EXPECT_CODE(ana.hello(), "OK");
  EXPECT_CODE(ana.ask(add(box(1, 1, 0.2, 1.5, 1.5, 0.5))), "TIMEOUT");
}

TEST_F(Working, HistoryTellsWhoDidWhat) {
  EXPECT_CODE(ana.ask(add(box(1, 1, 0.2, 1.5, 1.5, 0.5))), "OK");
  const Json answer = ana.ask(HistoryRequest{{}, {}, {}, {}, 100});
  EXPECT_CODE(answer, "OK");
  ASSERT_EQ(answer["answer"]["operations"].size(), 2u) << "a placement and an edit";
  EXPECT_EQ(answer["answer"]["operations"][1]["author"], "ana");
}

}  // namespace
}  // namespace concord::hmd
