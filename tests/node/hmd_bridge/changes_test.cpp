// What people change: edits, zones, leases, scenes.

#include "bridge_test.hpp"

namespace concord::hmd {
namespace {

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

TEST_F(Working, MovesAreRefusedForTheirReasons) {
  const Shape wall = box(1, 1, 0.2, 1.5, 1.5, 0.5);
  EditRequest move{EditOp::kMove, Frame::kMap, wall, std::array<double, 3>{1, 0, 0}, {}};
  move.base_revision = ana.ask(add(wall))["answer"]["revision"].get<std::int64_t>() - 1;
  EXPECT_CODE(ana.ask(move), "STALE_REV");
  move.base_revision.reset();
  move.move = std::array<double, 3>{1e6, 0, 0};
  EXPECT_CODE(ana.ask(move), "OUT_OF_BOUNDS");
  Client bert(lab);
  HelloRequest hello;
  hello.version = kProtocol;
  hello.name = "bert";
  EXPECT_CODE(bert.ask(hello), "OK");
  move.move = std::array<double, 3>{2, 2, 0};
  EXPECT_CODE(bert.ask(LeaseHoldRequest{"there", Frame::kMap, Box{{3, 3, 0}, {4, 4, 1}}}), "OK");
  EXPECT_CODE(ana.ask(move), "LOCKED") << "where it would go";
  EXPECT_CODE(bert.ask(LeaseFreeRequest{"there"}), "OK");
  EXPECT_CODE(bert.ask(LeaseHoldRequest{"here", Frame::kMap, Box{{1, 1, 0}, {2, 2, 1}}}), "OK");
  EXPECT_CODE(ana.ask(move), "LOCKED") << "where it stands";
  EXPECT_CODE(bert.ask(LeaseFreeRequest{"here"}), "OK");
  EXPECT_CODE(ana.ask(move), "OK");
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
  EXPECT_CODE(ana.ask(ZoneChangeRequest{"dock", ZoneKind::kAllowContact, Frame::kMap, zone.volume, revision - 1}),
              "STALE_REV");
  EXPECT_CODE(ana.ask(ZoneChangeRequest{"dock", ZoneKind::kAllowContact, Frame::kMap, zone.volume, revision}), "OK");
  EXPECT_CODE(ana.ask(ZoneChangeRequest{"none", ZoneKind::kNoGo, Frame::kMap, zone.volume, {}}), "NOT_FOUND");
  EXPECT_CODE(ana.ask(ZoneDeleteRequest{"dock", {}}), "OK");
  EXPECT_CODE(ana.ask(ZoneDeleteRequest{"dock", {}}), "NOT_FOUND");
}

TEST_F(Working, ASceneHasTheRevisionOfPeoplesCorrectionsWhateverWasSavedAndAfterARestart) {
  EXPECT_CODE(ana.ask(EditRequest{EditOp::kAdd, Frame::kMap, box(1, 1, 0.2, 1.5, 1.5, 0.5), {}, {}}), "OK");
  const SceneGetRequest get{Frame::kMap, {3.2, 3.2, 0}, 20};
  const std::int64_t revision = ana.ask(get)["answer"]["revision"];
  EXPECT_GT(revision, 0);
  lab.run(3);
  EXPECT_CODE(ana.ask(SaveRequest{"hall", {Format::kBt}, false}), "OK");
  EXPECT_EQ(ana.ask(get)["answer"]["revision"], revision);
  lab.restart_bridge();
  lab.run(3);
  Client back(lab);
  EXPECT_CODE(back.hello(), "OK");
  lab.run(1);
  EXPECT_EQ(back.ask(get)["answer"]["revision"], revision);
}

TEST_F(Working, ASceneGoesOutAndComesBack) {
  const Json got = ana.ask(SceneGetRequest{Frame::kMap, {3.2, 3.2, 0}, 20});
  EXPECT_CODE(got, "OK");
  EXPECT_EQ(got["answer"]["voxels"]["boxes"].size(), 1u) << "the floor";
  const std::int64_t revision = got["answer"]["revision"];
  SceneSendRequest scene{
      revision,
      Frame::kMap,
      {{EditOp::kAdd, box(1, 1, 0.2, 1.5, 1.5, 0.5)}, {EditOp::kDelete, box(1, 1, 0.2, 1.2, 1.2, 0.5)}},
      {{"dock", ZoneKind::kNoGo, Box{{3, 3, 0}, {4, 4, 1}}}},
      {}};
  const Json sent = ana.ask(scene);
  EXPECT_CODE(sent, "OK");
  EXPECT_EQ(sent["answer"]["edits"].size(), 2u);
  EXPECT_EQ(sent["answer"]["zones"], 1);
  EXPECT_CODE(ana.ask(scene), "STALE_REV") << "others changed it since";
  EXPECT_CODE(ana.ask(SceneSendRequest{revision, Frame::kMap, {}, {}, {}}), "EMPTY");
  EXPECT_CODE(ana.ask(SceneGetRequest{Frame::kMap, {0, 0, 0}, 21}), "BAD_REQUEST");
}

}  // namespace
}  // namespace concord::hmd
