// What others hold, or have changed since, is refused to whatever asks for it.

#include "bridge_test.hpp"

namespace concord::hmd {
namespace {

class Beside : public Working {
 protected:
  void SetUp() override {
    Working::SetUp();
    bert = std::make_unique<Client>(lab);
    HelloRequest hello;
    hello.version = kProtocol;
    hello.name = "bert";
    ASSERT_EQ(code_of_answer(bert->ask(hello)), "OK");
  }
  void hold() {
    ASSERT_TRUE(has_code(bert->ask(LeaseHoldRequest{"his", Frame::kMap, Box{{3, 3, 0}, {4, 4, 1}}}), "OK"));
  }
  std::unique_ptr<Client> bert;
  const Shape inside = box(3.2, 3.2, 0.2, 3.4, 3.4, 0.4);
};

TEST_F(Beside, DeletingVoxels) {
  const std::int64_t revision = ana.ask(add(inside))["answer"]["revision"];
  EditRequest erase{EditOp::kDelete, Frame::kMap, inside, {}, revision - 1};
  EXPECT_CODE(ana.ask(erase), "STALE_REV");
  erase.base_revision = revision;
  hold();
  EXPECT_CODE(ana.ask(erase), "LOCKED");
  EXPECT_CODE(ana.ask(EditRequest{EditOp::kDelete, Frame::kMap, box(9000, 0, 0, 9001, 1, 1), {}, {}}), "OUT_OF_BOUNDS");
  EXPECT_CODE(bert->ask(LeaseFreeRequest{"his"}), "OK");
  EXPECT_CODE(ana.ask(erase), "OK");
}

TEST_F(Beside, UndoAndRedo) {
  const std::string edit = ana.ask(add(inside))["answer"]["edit"];
  hold();
  EXPECT_CODE(ana.ask(UndoRequest{edit}), "LOCKED");
  EXPECT_CODE(bert->ask(UndoRequest{edit}), "OK");
  EXPECT_CODE(ana.ask(RedoRequest{edit}), "LOCKED");
}

TEST_F(Beside, ChangingAndDeletingAZone) {
  const Volume volume = Box{{3, 3, 0}, {4, 4, 1}};
  const Json added = ana.ask(ZoneAddRequest{"dock", ZoneKind::kNoGo, Frame::kMap, volume});
  ASSERT_TRUE(has_code(added, "OK"));
  const std::int64_t revision = added["answer"]["revision"];
  EXPECT_CODE(ana.ask(ZoneChangeRequest{"dock", ZoneKind::kNoGo, Frame::kMap, Prism{{{0, 0}, {1, 1}}, 0, 1}, {}}),
              "BAD_SHAPE");
  EXPECT_CODE(ana.ask(ZoneDeleteRequest{"dock", revision - 1}), "STALE_REV");
  hold();
  EXPECT_CODE(ana.ask(ZoneChangeRequest{"dock", ZoneKind::kAllowContact, Frame::kMap, volume, {}}), "LOCKED");
  EXPECT_CODE(ana.ask(ZoneDeleteRequest{"dock", {}}), "LOCKED");
  EXPECT_CODE(bert->ask(ZoneDeleteRequest{"dock", {}}), "OK");
}

TEST_F(Beside, SendingAScene) {
  const std::int64_t revision = ana.ask(SceneGetRequest{Frame::kMap, {3.2, 3.2, 0}, 20})["answer"]["revision"];
  hold();
  EXPECT_CODE(ana.ask(SceneSendRequest{revision, Frame::kMap, {{EditOp::kAdd, inside}}, {}, {}}), "LOCKED");
}

/// What was done is answered, not refused: the rest can be sent again.
TEST_F(Beside, OfASceneThatIsStoppedTheRestCanBeSentAgain) {
  const std::int64_t revision = ana.ask(SceneGetRequest{Frame::kMap, {3.2, 3.2, 0}, 20})["answer"]["revision"];
  hold();
  const Shape outside = box(1, 1, 0.2, 1.5, 1.5, 0.5);
  const Json stopped = ana.ask(
      SceneSendRequest{revision, Frame::kMap, {{EditOp::kAdd, outside}, {EditOp::kAdd, inside}}, {}, {}})["answer"];
  ASSERT_EQ(stopped["edits"].size(), 1u) << stopped;
  EXPECT_EQ(stopped["stopped"]["code"], "LOCKED");
  const SceneSendRequest again{revision, Frame::kMap, {{EditOp::kAdd, outside}}, {}, {}};
  EXPECT_CODE(ana.ask(again), "STALE_REV");
  SceneSendRequest knowing = again;
  knowing.known = std::vector{stopped["edits"][0].get<std::string>()};
  const Json rest = ana.ask(knowing);
  EXPECT_CODE(rest, "OK") << "what it did itself is no change by others";
  EXPECT_FALSE(rest["answer"].contains("stopped")) << rest;
  EXPECT_CODE(bert->ask(UndoRequest{stopped["edits"][0]}), "OK");
  EXPECT_CODE(ana.ask(knowing), "STALE_REV") << "that is one";
}

TEST_F(Beside, ASceneMayChangeTheSameVoxelsTwiceWhateverOthersDoElsewhere) {
  const std::int64_t revision = ana.ask(SceneGetRequest{Frame::kMap, {3.2, 3.2, 0}, 20})["answer"]["revision"];
  EXPECT_CODE(bert->ask(add(box(5, 5, 0.2, 5.2, 5.2, 0.4))), "OK");
  const Shape corner = box(3.2, 3.2, 0.2, 3.3, 3.3, 0.4);
  const std::vector<SceneEdit> edits = {{EditOp::kAdd, inside}, {EditOp::kDelete, corner}, {EditOp::kAdd, corner}};
  const Json sent = ana.ask(SceneSendRequest{revision, Frame::kMap, edits, {}, {}});
  EXPECT_CODE(sent, "OK");
  EXPECT_EQ(sent["answer"]["edits"].size(), 3u) << sent;
}

TEST_F(Beside, AddingAndRemovingAnObstacle) {
  const Volume there = Box{{3.2, 3.2, 0.2}, {3.4, 3.4, 0.4}};
  const std::int64_t revision = ana.ask(add(inside))["answer"]["revision"];
  EXPECT_CODE(ana.ask(ObstacleAddRequest{Frame::kMap, there, revision - 1}), "STALE_REV");
  EXPECT_CODE(ana.ask(ObstacleAddRequest{Frame::kMap, Box{{4, 4, 1}, {3, 3, 0}}, {}}), "BAD_SHAPE");
  EXPECT_CODE(ana.ask(ObstacleAddRequest{Frame::kMap, Box{{9000, 0, 0}, {9001, 1, 1}}, {}}), "OUT_OF_BOUNDS");
  const Json mine = ana.ask(ObstacleAddRequest{Frame::kMap, there, {}});
  ASSERT_TRUE(has_code(mine, "OK"));
  hold();
  EXPECT_CODE(ana.ask(ObstacleAddRequest{Frame::kMap, Box{{3.6, 3.6, 0.2}, {3.8, 3.8, 0.4}}, {}}), "LOCKED");
  EXPECT_CODE(ana.ask(ObstacleRemoveRequest{mine["answer"]["obstacle"]}), "LOCKED");
  EXPECT_CODE(bert->ask(LeaseFreeRequest{"his"}), "OK");
  EXPECT_CODE(ana.ask(ObstacleRemoveRequest{mine["answer"]["obstacle"]}), "OK");
}

}  // namespace
}  // namespace concord::hmd
