#include <fstream>

#include "semantic_station.hpp"

namespace concord {
namespace {

using Op = LabelRequest::Op;

class SemanticNodeTest : public SemanticStation {};

TEST_F(SemanticNodeTest, ALabelIsAnsweredWithItsNumbersAndSeenByAll) {
  const Answer answer = label("l1", "chair", 2, 20);
  ASSERT_TRUE(answer.ok) << answer.message;
  EXPECT_EQ(answer.process, "semantic");
  EXPECT_EQ(answer.count, 6);  // 2 to 7 are occupied
  ASSERT_EQ(lists_.size(), 1U);
  EXPECT_EQ(lists_[0].instances.at(0).of, (InstanceId{1, 1}));
  EXPECT_EQ(lists_[0].instances.at(0).voxels, 6);
  run();
  EXPECT_EQ(seen(1), "");
  EXPECT_EQ(seen(2), "chair 1");
  EXPECT_EQ(seen(7), "chair 1");
}

TEST_F(SemanticNodeTest, AskedTwiceItIsDoneOnceAndAnotherRequestMayNotTakeTheId) {
  ASSERT_TRUE(label("l1", "chair", 2, 3).ok);
  const Answer again = label("l1", "chair", 2, 3);
  EXPECT_TRUE(again.ok);
  EXPECT_EQ(again.revision, 1);
  EXPECT_EQ(lists_.at(0).instances.at(0).of, (InstanceId{1, 1}));
  EXPECT_EQ(label("l1", "table", 2, 3).code, "EXISTS");
  EXPECT_TRUE(label("l2", "chair", 2, 3).ok);
  EXPECT_EQ(lists_.at(0).instances.at(0).of, (InstanceId{1, 2}));
}

TEST_F(SemanticNodeTest, WhatWasAnsweredIsThereAfterAKill) {
  ASSERT_TRUE(label("l1", "chair", 0, 5).ok);
  ASSERT_TRUE(label("l2", "table", 4, 7).ok);
  ASSERT_TRUE(change("r1", Op::kRename, {2, 0}, "desk").ok);
  ASSERT_TRUE(undo("u1", "l1").ok);
  ASSERT_TRUE(undo("u2", "l1", true).ok);
  ASSERT_TRUE(change("o1", Op::kReassign, {1, 1}, "desk").ok);
  run();
  const BrickMap before = semantic_->view().shown();
  EXPECT_EQ(seen(0), "desk 2");
  EXPECT_EQ(seen(4), "desk 1");
  start();
  EXPECT_EQ(semantic_->view().shown().known_count(), before.known_count());
  EXPECT_EQ(seen(0), "desk 2");
  EXPECT_EQ(seen(4), "desk 1");
  EXPECT_TRUE(label("l1", "chair", 0, 5).ok);  // its answer was lost: asked again
  EXPECT_EQ(lists_.at(0).instances.at(0).of, (InstanceId{1, 1}));
}

TEST_F(SemanticNodeTest, DeletingAnInstanceIsOneEditThatMergeAnswersAndUndoes) {
  ASSERT_TRUE(label("l1", "chair", 0, 3).ok);
  ASSERT_TRUE(label("l2", "chair", 4, 5).ok);
  const Answer gone = change("d1", Op::kDelete, {1, 1});
  ASSERT_TRUE(gone.ok) << gone.message;
  EXPECT_EQ(gone.process, "merge");
  EXPECT_EQ(gone.count, 4);
  run();
  EXPECT_FALSE(is_occupied(merge_->map().at({0, 0, 0})));
  EXPECT_EQ(seen(0), "");
  EXPECT_EQ(seen(4), "chair 2");
  ASSERT_TRUE(ask("in/undo", encode(UndoRequest{"u1", "eva", "d1", false, bus_->now()})).ok);
  run();
  EXPECT_EQ(seen(0), "chair 1");
  ASSERT_TRUE(change("d2", Op::kDelete, {1, 0}).ok);
  run();
  EXPECT_EQ(seen(0), "");
  EXPECT_EQ(seen(4), "");
}

TEST_F(SemanticNodeTest, ADeletionAskedAgainIsAnsweredAlikeAfterARestartToo) {
  ASSERT_TRUE(label("l1", "chair", 0, 3).ok);
  ASSERT_TRUE(change("d1", Op::kDelete, {1, 1}).ok);
  run();
  EXPECT_TRUE(change("d1", Op::kDelete, {1, 1}).ok);
  start();
  const Answer again = change("d1", Op::kDelete, {1, 1});
  EXPECT_TRUE(again.ok) << again.message;
  EXPECT_EQ(again.count, 4);
  EXPECT_EQ(change("d2", Op::kDelete, {1, 1}).code, "EMPTY");
}

TEST_F(SemanticNodeTest, AnIdOfOneDeletionIsNoOthersAfterARestartToo) {
  ASSERT_TRUE(label("l1", "chair", 0, 3).ok);
  ASSERT_TRUE(label("l2", "table", 4, 7).ok);
  ASSERT_TRUE(change("d1", Op::kDelete, {1, 1}).ok);
  run();
  EXPECT_EQ(change("d1", Op::kDelete, {2, 1}).code, "EXISTS");
  start();
  EXPECT_EQ(change("d1", Op::kDelete, {2, 1}).code, "EXISTS");
  EXPECT_TRUE(change("d1", Op::kDelete, {1, 1}).ok);
  EditRequest edit;
  edit.id = "e1";
  edit.author = "eva";
  edit.op = EditRequest::Op::kDelete;
  edit.shape = VoxelList{site_.resolution, {{{15, 0, 0}, {15, 0, 0}}}};
  edit.utime = bus_->now();
  ASSERT_TRUE(ask("in/edit", encode(edit)).ok);
  run();
  EXPECT_EQ(change("e1", Op::kDelete, {2, 1}).code, "EXISTS") << "a plain edit has it";
  EXPECT_EQ(seen(4), "table 1");
}

TEST_F(SemanticNodeTest, TakingALabelOffLeavesTheVoxels) {
  ASSERT_TRUE(label("l1", "chair", 0, 3).ok);
  ASSERT_TRUE(change("o1", Op::kTakeOff, {1, 1}).ok);
  run();
  EXPECT_EQ(seen(0), "");
  EXPECT_TRUE(is_occupied(merge_->map().at({0, 0, 0})));
}

TEST_F(SemanticNodeTest, RefusesEmptySelectionsUnknownSpaceAndHostileNames) {
  EXPECT_EQ(label("l1", "chair", 100, 120).code, "EMPTY");
  EXPECT_EQ(label("l2", "", 0, 3).code, "BAD_NAME");
  EXPECT_EQ(change("c1", Op::kRename, {9, 0}, "x").code, "NOT_FOUND");
  EXPECT_EQ(change("c2", Op::kDelete, {9, 1}).code, "NOT_FOUND");
  EXPECT_EQ(undo("u1", "nobody").code, "NOT_FOUND");
  LabelRequest other = request("l3", Op::kLabel);
  other.name = "chair";
  other.shape = VoxelList{0.2, {{{0, 0, 0}, {1, 0, 0}}}};
  EXPECT_EQ(ask("in/label", encode(other)).code, "RES_MISMATCH");
  EXPECT_EQ(counters_.get("refused.in/label.EMPTY"), 1);
  Bytes noise = encode(other);
  noise.resize(noise.size() - 3);
  bus_->publish("in/label", noise);
  bus_->deliver();
  EXPECT_EQ(counters_.get("refused.in/label.MALFORMED"), 1);
  EXPECT_TRUE(label("l4", "chair", 0, 3).ok);
}

TEST_F(SemanticNodeTest, TellsWhatIsWhere) {
  ASSERT_TRUE(label("l1", "chair", 0, 1).ok);
  ASSERT_TRUE(label("l2", "table", 4, 7).ok);
  LabelQuery query{"q1", LabelQuery::Kind::kAll, "", {0, 0, 0}, 0};
  EXPECT_EQ(ask("in/label_query", encode(query, bus_->now())).count, 2);
  ASSERT_EQ(lists_.size(), 1U);
  EXPECT_EQ(lists_[0].instances.at(1).name, "table");
  EXPECT_EQ(lists_[0].instances.at(1).voxels, 4);
  query = {"q2", LabelQuery::Kind::kAt, "", {0.45, 0.05, 0.05}, 0};
  EXPECT_EQ(ask("in/label_query", encode(query, bus_->now())).count, 1);
  query = {"q3", LabelQuery::Kind::kClass, "sofa", {0, 0, 0}, 0};
  EXPECT_EQ(ask("in/label_query", encode(query, bus_->now())).code, "NOT_FOUND");
}

TEST_F(SemanticNodeTest, ALabelGoesAlongWithTheAgentThatItLiesOnAndBackAfterRestartsToo) {
  ASSERT_TRUE(label("l1", "chair", 0, 3).ok);
  const auto aligned_at = [this](const std::string& id, double x) {
    Transform T = Transform::Identity();
    T.translation().x() = x;
    ASSERT_TRUE(ask("in/transform", encode(TransformRequest{id, "eva", "robot1", "", T}, bus_->now())).ok);
    run();
  };
  aligned_at("t2", 1.0);
  EXPECT_EQ(seen(0), "");
  EXPECT_EQ(seen(10), "chair 1");
  EXPECT_EQ(seen(13), "chair 1");
  EXPECT_EQ(seen(14), "");
  ASSERT_TRUE(label("l2", "table", 14, 15).ok);
  start();
  EXPECT_EQ(seen(10), "chair 1");
  EXPECT_EQ(seen(14), "table 1");
  ASSERT_TRUE(ask("in/undo", encode(UndoRequest{"u1", "eva", "t2", false, bus_->now()})).ok);
  run();
  EXPECT_EQ(seen(0), "chair 1");
  EXPECT_EQ(seen(4), "table 1");
  EXPECT_EQ(seen(10), "");
}

TEST_F(SemanticNodeTest, ALabelOnWhatPeoplePinnedStaysInTheMap) {
  EditRequest edit;
  edit.id = "e1";
  edit.author = "eva";
  edit.shape = VoxelList{site_.resolution, {{{30, 0, 0}, {33, 0, 0}}}};
  ASSERT_TRUE(ask("in/edit", encode(edit)).ok);
  run();
  ASSERT_TRUE(label("l1", "wall", 30, 33).ok);
  Transform T = Transform::Identity();
  T.translation().x() = 1.0;
  ASSERT_TRUE(ask("in/transform", encode(TransformRequest{"t2", "eva", "robot1", "", T}, bus_->now())).ok);
  run();
  EXPECT_EQ(seen(30), "wall 1");
}

TEST_F(SemanticNodeTest, ASavedMapHasTheLabelsAndALoadedOneGivesThemBack) {
  ASSERT_TRUE(label("l1", "chair", 0, 3).ok);
  ASSERT_TRUE(label("l2", "table", 2, 7).ok);
  ASSERT_TRUE(undo("u1", "l1").ok);
  const MapRequest save{"s1", MapRequest::Op::kSave, "hall", {"concord"}, false, ""};
  Answer saved = ask("in/map_request", encode(save, bus_->now()));
  if (saved.code == "BUSY") saved = ask("in/map_request", encode(save, bus_->now()));
  ASSERT_TRUE(saved.ok) << saved.message;
  EXPECT_EQ(saved.process, "merge");
  EXPECT_EQ(saved.message, "saved hall.concord");
  EXPECT_TRUE(std::filesystem::is_empty(site_.state / "handover"));

  stop();
  for (const char* part : {"", "-wal", "-shm"})
    std::filesystem::remove(site_.state / (std::string("semantic.db") + part));
  start();
  EXPECT_EQ(seen(4), "");
  const MapRequest load{"o1", MapRequest::Op::kLoad, "hall", {"concord"}, false, ""};
  ask("in/map_request", encode(load, bus_->now()));
  EXPECT_TRUE(
      std::ranges::any_of(answers_, [](const Answer& a) { return a.process == "semantic" && a.code == "BUSY"; }));
  run();
  EXPECT_EQ(seen(4), "");  // not before merge has taken it
  ask("out/answer", encode(Answer{"o1", "merge", true, "OK", "", 9, 3}, bus_->now()));
  ASSERT_TRUE(
      std::ranges::any_of(answers_, [](const Answer& a) { return a.process == "semantic" && a.ok && a.count == 3; }));
  run();
  EXPECT_EQ(seen(0), "");
  EXPECT_EQ(seen(4), "table 1");
  ASSERT_TRUE(undo("u2", "l1", true).ok);  // what was undone there can be redone here
  run();
  EXPECT_EQ(seen(0), "chair 1");
  EXPECT_EQ(seen(2), "table 1");
}

TEST_F(SemanticNodeTest, ThingsOfAClassWithTermsAreZonesForThePlanner) {
  site_.classes = {{"chair", {.margin = 0.5}}, {"sofa", {.margin = 1.0, .cost = 4, .cost_margin = 2.0}}};
  start();
  std::vector<Zone> zones;
  ListReceiver<Zone> list(*bus_, counters_, "out/label_zones", [&](const std::vector<Zone>& all) { zones = all; });
  run();
  EXPECT_TRUE(list.synced());
  EXPECT_TRUE(zones.empty());
  ASSERT_TRUE(label("l1", "chair", 0, 3).ok);
  ASSERT_TRUE(label("l2", "table", 4, 7).ok);
  run();
  ASSERT_EQ(zones.size(), 1U);
  EXPECT_EQ(zones[0].name, "chair 1");
  EXPECT_EQ(zones[0].kind, Zone::Kind::kNoGo);
  EXPECT_TRUE(contains(zones[0].volume, zones[0].T_map_zone, {0.85, 0.05, 0.05}));
  EXPECT_FALSE(contains(zones[0].volume, zones[0].T_map_zone, {0.95, 0.05, 0.05}));
  ASSERT_TRUE(change("r1", Op::kRename, {2, 0}, "sofa").ok);
  ASSERT_TRUE(change("o1", Op::kTakeOff, {1, 1}).ok);
  run();
  ASSERT_EQ(zones.size(), 2U);
  EXPECT_EQ(zones[0].name, "near sofa 1");
  EXPECT_EQ(zones[0].kind, Zone::Kind::kCostly);
  EXPECT_EQ(zones[0].cost, 4);
  EXPECT_TRUE(contains(zones[0].volume, zones[0].T_map_zone, {2.75, 0.05, 0.05}));
  EXPECT_EQ(zones[1].name, "sofa 1");
  EXPECT_EQ(zones[1].kind, Zone::Kind::kNoGo);
  EXPECT_FALSE(contains(zones[1].volume, zones[1].T_map_zone, {2.75, 0.05, 0.05}));
}

TEST_F(SemanticNodeTest, LabelsStayWhereVoxelsComeBack) {
  ASSERT_TRUE(label("l1", "chair", 0, 3).ok);
  agent_map_.set({0, 0, 0}, Brick());
  agent_stream_->touch({0, 0, 0});
  run();
  EXPECT_EQ(seen(0), "");
  agent_map_.set({0, 0, 0}, Brick::uniform({0xFF, 0, 0, 0, 0, 0, 0, 0}, kOccupied));
  agent_stream_->touch({0, 0, 0});
  run();
  EXPECT_EQ(seen(0), "chair 1");
}

}  // namespace
}  // namespace concord
