#include "asset_station.hpp"

namespace concord {
namespace {

using AssetsNodeTest = AssetStation;

TEST_F(AssetsNodeTest, AModelIsOccupiedAndLabelledInsideToo) {
  const Answer answer = inject("a1", "cube", 2.0);
  ASSERT_TRUE(answer.ok) << answer.message;
  EXPECT_EQ(answer.process, "semantic");
  EXPECT_EQ(answer.count, 11 * 11 * 11);
  run();
  EXPECT_TRUE(is_there(25));
  EXPECT_EQ(seen_at(25), "box 1");
  EXPECT_FALSE(is_there(31));
  EXPECT_TRUE(inject("a1", "cube", 2.0).ok);  // its answer was lost
  EXPECT_EQ(semantic_->view().slot_count(), 1U);
  EXPECT_EQ(inject("a1", "cube", 3.0).code, "EXISTS");
}

TEST_F(AssetsNodeTest, UndoingItsEditUndoesItWholeAndRedoBringsItBack) {
  ASSERT_TRUE(inject("a1", "cube", 2.0).ok);
  ASSERT_TRUE(ask("in/undo", encode(UndoRequest{"u1", "eva", "asset-a1", false, bus_->now()})).ok);
  run();
  EXPECT_FALSE(is_there(25));
  EXPECT_EQ(seen_at(25), "");
  start();
  EXPECT_EQ(seen_at(25), "");
  ASSERT_TRUE(ask("in/undo", encode(UndoRequest{"u2", "eva", "asset-a1", true, bus_->now()})).ok);
  run();
  EXPECT_EQ(seen_at(25), "box 1");
  start();
  EXPECT_EQ(seen_at(25), "box 1");
}

TEST_F(AssetsNodeTest, RobotsKeepAwayFromItWhereverItIsAndAfterARestartToo) {
  site_.classes = {{"box", {.margin = 0.5}}};
  std::unique_ptr<ListReceiver<Zone>> zones;
  const auto begin_anew = [&] {
    zones.reset();
    start();
    zones = std::make_unique<ListReceiver<Zone>>(*bus_, counters_, "out/label_zones", [](const auto&) {});
    run();
  };
  const auto near = [&](double x) {
    return std::ranges::any_of(zones->items(), [&](const Zone& zone) {
      return contains(zone.volume, zone.T_map_zone, {x, 0.5, 0.5});
    });
  };
  begin_anew();
  ASSERT_TRUE(inject("a1", "cube", 2.0).ok);
  run();
  EXPECT_TRUE(near(1.7));
  begin_anew();
  EXPECT_TRUE(near(1.7)) << "after a restart";
  ASSERT_TRUE(undo_edit("u1", "asset-a1").ok);
  EXPECT_FALSE(near(1.7)) << "it is not there any more";
  ASSERT_TRUE(undo_edit("u2", "asset-a1", true).ok);
  EXPECT_TRUE(near(1.7));
  ASSERT_TRUE(move("m1", "a1", 5.0).ok);
  run();
  EXPECT_TRUE(near(4.7));
  EXPECT_FALSE(near(1.7));
  zones.reset();
}

TEST_F(AssetsNodeTest, ItsLabelIsNotUndoneAlone) {
  ASSERT_TRUE(inject("a1", "cube", 2.0).ok);
  run();
  LabelRequest undo;
  undo.id = "u1";
  undo.author = "eva";
  undo.op = LabelRequest::Op::kUndo;
  undo.correction_id = "a1";
  undo.utime = bus_->now();
  const Answer refused = ask("in/label", encode(undo));
  EXPECT_EQ(refused.code, "BAD_REQUEST");
  EXPECT_NE(refused.message.find("asset-a1"), std::string::npos) << refused.message;
  EXPECT_EQ(seen_at(25), "box 1");
  EXPECT_TRUE(take_out("d1", "a1").ok);
}

TEST_F(AssetsNodeTest, AModelIsMovedAsOneThingAndKeepsItsName) {
  ASSERT_TRUE(inject("a1", "cube", 2.0).ok);
  const Answer answer = move("m1", "a1", 5.0);
  ASSERT_TRUE(answer.ok) << answer.message;
  run();
  EXPECT_EQ(places(), "-|box 1|-|");
  EXPECT_EQ(told_x(), 5.0);
  ASSERT_TRUE(move("m2", "a1", 8.0).ok);
  move("m1", "a1", 5.0);  // an old copy does nothing
  run();
  EXPECT_EQ(places(), "-|-|box 1|");
  start();
  EXPECT_EQ(places(), "-|-|box 1|");
  EXPECT_EQ(told_x(), 8.0);
  ASSERT_TRUE(undo_edit("u1", "asset-m2").ok);
  EXPECT_EQ(places(), "-|box 1|-|");
  ASSERT_TRUE(undo_edit("u2", "asset-m1").ok);
  EXPECT_EQ(places(), "box 1|-|-|");
  EXPECT_EQ(told_x(), 2.0);
  ASSERT_TRUE(undo_edit("u3", "asset-m1", true).ok);
  EXPECT_EQ(places(), "-|box 1|-|");
  start();
  EXPECT_EQ(places(), "-|box 1|-|");
}

TEST_F(AssetsNodeTest, AMovedModelIsTakenOutForGoodWhereverItIs) {
  ASSERT_TRUE(inject("a1", "cube", 2.0).ok);
  ASSERT_TRUE(move("m1", "a1", 5.0).ok);
  const Answer gone = take_out("d1", "a1");
  ASSERT_TRUE(gone.ok) << gone.message;
  run();
  EXPECT_EQ(places(), "-|-|-|");
  EXPECT_TRUE(take_out("d1", "a1").ok);  // its answer was lost
  start();
  EXPECT_TRUE(take_out("d1", "a1").ok);
  EXPECT_EQ(places(), "-|-|-|");
  EXPECT_EQ(take_out("d2", "a1").code, "NOT_FOUND");
  EXPECT_EQ(move("m2", "a1", 8.0).code, "NOT_FOUND");
  ASSERT_TRUE(undo_edit("u1", "asset-m1", true).ok);
  EXPECT_EQ(places(), "-|box 1|-|");
}

TEST_F(AssetsNodeTest, AnEditThatIsThereAlreadyIsNotTakenForTheInjections) {
  EditRequest edit;
  edit.id = "asset-a1";
  edit.author = "eva";
  edit.shape = VoxelList{site_.resolution, {{{15, 0, 0}, {15, 0, 0}}}};
  edit.utime = bus_->now();
  ASSERT_TRUE(ask("in/edit", encode(edit)).ok);
  run();
  EXPECT_EQ(inject("a1", "cube", 2.0).code, "EXISTS");
  EXPECT_EQ(semantic_->view().slot_count(), 0U);
  ASSERT_TRUE(inject("a2", "cube", 2.0).ok);
  run();
  stop();
  for (const char* part : {"", "-wal", "-shm"})
    std::filesystem::remove(site_.state / (std::string("semantic.db") + part));
  start();
  EXPECT_EQ(inject("a2", "cube", 5.0).code, "EXISTS") << "the labels were lost, merge has it elsewhere";
  run();
  EXPECT_FALSE(is_there(55));
}

TEST_F(AssetsNodeTest, AnIdOfOneRemovalIsNoOthersAfterARestartToo) {
  ASSERT_TRUE(inject("a1", "cube", 2.0).ok);
  ASSERT_TRUE(inject("a2", "cube", 5.0).ok);
  run();
  ASSERT_TRUE(take_out("d1", "a1").ok);
  run();
  EXPECT_EQ(take_out("d1", "a2").code, "EXISTS");
  start();
  EXPECT_EQ(take_out("d1", "a2").code, "EXISTS");
  EXPECT_TRUE(take_out("d1", "a1").ok);
  EXPECT_EQ(places(), "-|box 2|-|");
}

TEST_F(AssetsNodeTest, AModelOfMoreBoxesThanARequestHasIsRefusedInWords) {
  std::ofstream out(site_.state / "assets/cube.obj");  // a thin panel that leans both ways
  out << "v 0 0 0\nv 44000 0 19000\nv 44000 44000 42000\nv 0 44000 23000\nf 1 2 3\nf 1 3 4\n";
  out.close();
  const Answer answer = inject("a1", "cube", 2.0);
  EXPECT_EQ(answer.code, "TOO_LARGE");
  EXPECT_NE(answer.message.find("scattered"), std::string::npos) << answer.message;
  EXPECT_EQ(semantic_->view().slot_count(), 0U);
}

TEST_F(AssetsNodeTest, AMoveThatMayNotLeaveItsOldPlaceIsUndone) {
  ASSERT_TRUE(inject("a1", "cube", 2.0).ok);
  ASSERT_TRUE(lease("bob", 2.0));
  EXPECT_EQ(move("m1", "a1", 5.0).code, "LOCKED");
  run();
  EXPECT_EQ(places(), "box 1|-|-|");
}

TEST_F(AssetsNodeTest, AMoveWhoseUndoMayNotComeBackStaysAndIsNotAskedForAtTheSpeedOfTheBus) {
  ASSERT_TRUE(inject("a1", "cube", 2.0).ok);
  ASSERT_TRUE(move("m1", "a1", 5.0).ok);
  ASSERT_TRUE(lease("bob", 2.0));
  int asked = 0;
  for (const char* channel : {"in/undo", "in/edit", "in/history_request"}) {
    bus_->subscribe(channel, [&asked](const std::string&, auto) { ++asked; });
  }
  ASSERT_TRUE(ask("in/undo", encode(UndoRequest{"u1", "eva", "asset-m1", false, bus_->now()})).ok);
  run();
  EXPECT_EQ(places(), "-|box 1|-|") << "a model is somewhere";
  EXPECT_LT(asked, 12);
  EXPECT_GT(counters_.get("refused.asset_undo.CONFLICT"), 0) << "and it is said";
  run(20'000'000);  // the lease is over
  EXPECT_EQ(places(), "-|box 1|-|");
  ASSERT_TRUE(undo_edit("u2", "asset-m1").ok);
  EXPECT_EQ(places(), "box 1|-|-|");
}

TEST_F(AssetsNodeTest, ItsOldPlaceRedoneIsWhereItIsAndOneDeleteTakesItOut) {
  ASSERT_TRUE(inject("a1", "cube", 2.0).ok);
  ASSERT_TRUE(move("m1", "a1", 5.0).ok);
  ASSERT_TRUE(move("m2", "a1", 8.0).ok);
  ASSERT_TRUE(undo_edit("u1", "asset-a1", true).ok);
  run();
  EXPECT_EQ(places(), "box 1|-|-|") << "it is one thing";
  start();
  EXPECT_EQ(places(), "box 1|-|-|");
  ASSERT_TRUE(take_out("d1", "a1").ok);
  run();
  EXPECT_EQ(places(), "-|-|-|");
}

TEST_F(AssetsNodeTest, WhatComesWithALoadedMapShowsThoughMergeHasItsEditAlready) {
  ASSERT_TRUE(inject("a1", "cube", 2.0).ok);
  run();
  const MapRequest save{"s1", MapRequest::Op::kSave, "hall", {"concord"}, false, ""};
  Answer saved = ask("in/map_request", encode(save, bus_->now()));
  if (saved.code == "BUSY") saved = ask("in/map_request", encode(save, bus_->now()));
  ASSERT_TRUE(saved.ok) << saved.message;
  stop();
  for (const char* part : {"", "-wal", "-shm"})
    std::filesystem::remove(site_.state / (std::string("semantic.db") + part));
  start();
  EXPECT_EQ(places(), "|-|-|") << "there, but nobody knows what it is";
  ask("in/map_request", encode(MapRequest{"o1", MapRequest::Op::kLoad, "hall", {"concord"}, false, ""}, bus_->now()));
  ask("out/answer", encode(Answer{"o1", "merge", true, "OK", "", 9, 3}, bus_->now()));
  int edits = 0;
  bus_->subscribe("in/edit", [&edits](const std::string&, auto) { ++edits; });
  run();
  EXPECT_EQ(places(), "box 1|-|-|");
  EXPECT_EQ(edits, 0);
}

TEST_F(AssetsNodeTest, RefusesAModelThatFillsTooMuchBeforeItTakesMemory) {
  std::ofstream(site_.state / "assets/assets.yaml") << "cube: {file: cube.obj, class: box, unit: 0.044}\n";
  run();
  const Answer answer = inject("a1", "cube", 2.0);
  EXPECT_EQ(answer.code, "TOO_LARGE") << answer.message;
  EXPECT_NE(answer.message.find("500000"), std::string::npos) << answer.message;
}

TEST_F(AssetsNodeTest, AKillBetweenTheTwoHalvesOfAMoveLosesNothing) {
  ASSERT_TRUE(inject("a1", "cube", 2.0).ok);
  stop();
  {
    SemanticStore store(site_.state / "semantic.db", site_.resolution);
    Transform T = Transform::Identity();
    T.translation().x() = 5.0;
    ASSERT_TRUE(store.put({2, "m1", "eva", 5, 7,
                           LabelCorrection::Claim{{1, 1}, "", {{55, 5, 5}}, "asset-m1", {}, {"cube", T, "asset-a1"}}}));
  }
  start();
  run();
  EXPECT_EQ(places(), "-|box 1|-|");
  start();
  EXPECT_EQ(places(), "-|box 1|-|");
}

TEST_F(AssetsNodeTest, AKillBetweenTheIntentAndTheEditLosesNothing) {
  stop();
  {
    SemanticStore store(site_.state / "semantic.db", site_.resolution);
    ASSERT_TRUE(store.put(
        {1, "a1", "eva", 5, 7,
         LabelCorrection::Claim{{1, 1}, "box", {{25, 5, 5}}, "asset-a1", {}, {"cube", Transform::Identity(), ""}}}));
  }
  start();
  run();
  EXPECT_TRUE(is_there(25));
  EXPECT_EQ(seen_at(25), "box 1");
  EXPECT_TRUE(ask("in/undo", encode(UndoRequest{"u1", "eva", "asset-a1", false, bus_->now()})).ok);
}

TEST_F(AssetsNodeTest, WhatMergeRefusesIsNotThere) {
  ASSERT_TRUE(lease("bob", 2.0));
  EXPECT_EQ(inject("a1", "cube", 2.0).code, "LOCKED");
  run(20'000'000);  // the lease is over
  EXPECT_FALSE(is_there(25));
  EXPECT_EQ(seen_at(25), "");
  EXPECT_TRUE(inject("a2", "cube", 2.0).ok);
  run();
  EXPECT_EQ(seen_at(25), "box 2");  // no number twice
}

TEST_F(AssetsNodeTest, ARevisionOfTheMapInASavesAnswerIsNoneOfTheHistory) {
  ASSERT_TRUE(inject("a1", "cube", 2.0).ok);
  run();
  int questions = 0;
  bus_->subscribe("in/history_request", [&questions](const std::string&, auto) { ++questions; });
  bus_->publish("out/answer", encode(Answer{"save1", "merge", true, "OK", "saved", 18'695, 1}, bus_->now()));
  run();
  EXPECT_EQ(questions, 1) << "it may have been news";
  EXPECT_TRUE(inject("a2", "cube", 5.0).ok);
}

TEST_F(AssetsNodeTest, HistoryThatWasNotAnsweredIsAskedForAgain) {
  stop();
  bus_ = std::make_unique<LockstepBus>(bus_->now());  // merge is not there
  semantic_ = std::make_unique<SemanticNode>(NodeContext{*bus_, counters_, site_, "semantic", bus_->now()},
                                             std::launch::deferred);
  int questions = 0;
  bus_->subscribe("in/history_request", [&questions](const std::string&, auto) { ++questions; });
  bus_->publish("out/answer", encode(Answer{"u1", "merge", true, "OK", "undone", 7, 1}, bus_->now()));
  run(3'500'000);
  EXPECT_EQ(questions, 4) << "at once, and each second";
}

TEST_F(AssetsNodeTest, RefusesWhatIsNoAsset) {
  EXPECT_EQ(inject("a1", "sphere", 0).code, "NOT_FOUND");
  EXPECT_EQ(inject("a2", "none", 0).code, "NOT_FOUND");
  EXPECT_EQ(inject("a3", "cube", 5000).code, "OUT_OF_BOUNDS");
  EXPECT_EQ(inject(std::string(75, 'a'), "cube", 0).code, "BAD_REQUEST");
  EXPECT_EQ(semantic_->view().slot_count(), 0U);
}

}  // namespace
}  // namespace concord
