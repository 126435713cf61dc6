#include <limits>

#include "core/map_archive.hpp"
#include "people_station.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

/// Where robots lie that send poses, a layer, or both, in whatever order they come and go.
class PlacementTest : public PeopleStation {
 protected:
  /// Of the one agent that is there; none: it is not aligned.
  [[nodiscard]] std::optional<double> x_of_robot() const {
    if (agents_.agents.size() != 1 || !agents_.agents[0].aligned) return std::nullopt;
    return agents_.agents[0].T_map_agent.translation().x();
  }
  Answer save(const std::string& id, const std::string& name) {
    return ask("in/map_request",
               encode(MapRequest{id, MapRequest::Op::kSave, name, {"concord"}, true, ""}, bus_->now()));
  }
  [[nodiscard]] std::size_t layers_saved(const std::string& name) const {
    const auto bytes = read_whole_file(site_.state / "maps" / (name + ".concord"), 1'000'000);
    return bytes ? read_map_archive(*bytes)->layers.size() : 0;
  }
  /// A file that was made elsewhere, of these corrections and no layer.
  Answer load_from_elsewhere(const std::vector<Correction>& corrections) {
    MapArchiveWriter writer(site_.resolution);
    for (const Correction& correction : corrections) EXPECT_TRUE(writer.add(correction));
    std::filesystem::create_directories(site_.state / "maps");
    EXPECT_TRUE(write_whole_file(site_.state / "maps/other.concord", *std::move(writer).finish()));
    return ask("in/map_request",
               encode(MapRequest{"load", MapRequest::Op::kLoad, "other", {"concord"}, false, ""}, bus_->now()));
  }
};

TEST_F(PlacementTest, APoseWhoseTimeIsNoneIsRefused) {
  say_pose();
  for (const std::int64_t none :
       {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}}) {
    run(4'000'000);
    say_pose(none);
  }
  EXPECT_EQ(counters_.get("refused.in/robot1/pose.BAD_REQUEST"), 3);
  run(4'000'000);
  say_pose();
  EXPECT_TRUE(place("t1", at(1, 0)).ok);
}

TEST_F(PlacementTest, AfterARestartAPoseIsNotTheLayerThatIsAwaited) {
  send_wall();
  ASSERT_TRUE(place("t1", at(0, 0)).ok);
  start();
  say_pose();
  EXPECT_EQ(place("t2", at(3, 0)).code, "BUSY") << "it would hold for no layer";
  EditRequest request = edit_of("e1", "eva", {1, 1, 1});
  request.frame = {"robot1", "frame1"};
  EXPECT_EQ(edit(request).code, "BUSY");
  EXPECT_EQ(weigh("w1", "robot1", 2).code, "BUSY");
  agent_stream_->begin("frame1");
  run();
  EXPECT_EQ(x_of_robot(), 0.0);
  EXPECT_TRUE(place("t2", at(3, 0)).ok);
  run();
  EXPECT_EQ(x_of_robot(), 3.0);
}

TEST_F(PlacementTest, ARobotPlacedByItsPosesStaysWhenItsFirstSubmapComes) {
  say_pose();
  ASSERT_TRUE(place("t1", at(3, 0)).ok);
  send_wall();
  EXPECT_EQ(x_of_robot(), 3.0);
  EXPECT_EQ(node_->map().occupied_count(), 8u);
  for (int i = 0; i < 2; ++i) {
    start();
    agent_stream_->begin("frame1");
    run();
    EXPECT_EQ(x_of_robot(), 3.0) << "also after a restart, before any pose";
  }
  ASSERT_TRUE(place("t2", at(5, 0)).ok);
  start();
  agent_stream_->begin("frame1");
  run();
  EXPECT_EQ(x_of_robot(), 5.0) << "the layer's own is later";
}

TEST_F(PlacementTest, WhatPosesWerePlacedByHoldsForNoOtherFrame) {
  say_pose();
  ASSERT_TRUE(place("t1", at(3, 0)).ok);
  agent_stream_->begin("frame2");
  run();
  ASSERT_EQ(agents_.agents.size(), 1u);
  EXPECT_EQ(x_of_robot(), std::nullopt);
}

TEST_F(PlacementTest, WhoWasRemovedAndStillSendsPosesWaitsOutside) {
  for (const bool by_poses : {false, true}) {
    ++incarnation_;
    start();
    if (by_poses) {
      run(11'000'000);  // the layer of the one before is awaited no more
      say_pose();
      ASSERT_TRUE(place("t-poses", at(2, 0)).ok);
    }
    send_wall();
    if (!by_poses) {
      ASSERT_TRUE(place("t-layer", at(2, 0)).ok);
    }
    run();
    ASSERT_EQ(x_of_robot(), 2.0);
    agent_stream_->end();
    run();
    say_pose();
    run();
    ASSERT_EQ(agents_.agents.size(), 1u);
    EXPECT_EQ(x_of_robot(), std::nullopt) << by_poses;
    for (const bool has_layer : {false, true}) {
      if (has_layer) ++incarnation_;
      start();
      say_pose();
      if (has_layer) agent_stream_->begin("frame1");
      run();
      ASSERT_EQ(agents_.agents.size(), 1u);
      EXPECT_EQ(x_of_robot(), std::nullopt) << "nor after a restart, " << by_poses << has_layer;
    }
    agent_stream_->end();
    run();
  }
}

TEST_F(PlacementTest, APersonsIdLikeOneOfOursIsInNobodysWay) {
  ASSERT_TRUE(add("carried-2", {9, 9, 9}).ok);
  say_pose();
  ASSERT_EQ(place("t1", at(3, 0)).revision, 2);
  send_wall();
  EXPECT_EQ(x_of_robot(), 3.0);
  EXPECT_EQ(add("e1", {9, 9, 8}).revision, 4) << "the placement that was carried over is the third";
  EXPECT_EQ(add("carried-2.1", {9, 9, 9}).code, "EXISTS");
}

TEST_F(PlacementTest, AFileFromElsewhereMovesAndWeighsNobodyWhoIsNotInIt) {
  say_pose();
  ASSERT_TRUE(place("t1", at(1, 0)).ok);
  const std::vector<Correction> theirs = {
      {1, "theirs-1", "ann", 1, 7, Correction::Placement{"robot1", "frame1", 0, false, at(9, 9)}},
      {2, "theirs-2", "ann", 1, 8, Correction::Weight{"robot1", 77}},
      {3, "theirs-3", "ann", 1, 9, Correction::Placement{"robot1", "frame1", incarnation_, true, at(8, 8)}}};
  const Answer loaded = load_from_elsewhere(theirs);
  ASSERT_TRUE(loaded.ok) << loaded.message;
  EXPECT_EQ(loaded.count, 2) << "their placements, as history";
  run();
  EXPECT_EQ(x_of_robot(), 1.0);
  EXPECT_EQ(agents_.agents[0].weight, 1);
  HistoryRequest all;
  all.id = "h1";
  ASSERT_TRUE(history(all).ok);
  ASSERT_EQ(histories_.size(), 1u);
  EXPECT_EQ(histories_[0].operations.size(), 3u);
  send_wall();
  EXPECT_EQ(x_of_robot(), 1.0);
}

TEST_F(PlacementTest, ASavedMapHasEveryLayerOrIsRefused) {
  send_wall();
  run();
  ASSERT_TRUE(save("s1", "one").ok);
  EXPECT_EQ(layers_saved("one"), 1u);
  ingest_is_up_ = false;
  restart();
  run(20'000'000);
  EXPECT_EQ(save("s2", "two").code, "BUSY") << "nobody has said yet which agents there are";
  ingest_is_up_ = true;
  agent_stream_->begin("frame1");
  run(1'000'000);
  EXPECT_EQ(save("s2", "two").code, "BUSY");
  run(3'000'000);
  ASSERT_TRUE(save("s2", "two").ok);
  EXPECT_EQ(layers_saved("two"), 1u);
  bus_->publish("out/agent/robot2/digest",
                encode(BrickDigest{bus_->now(), bus_->now(), "frame1", site_.resolution, 5, 2, 3, 1}));
  bus_->deliver();
  EXPECT_EQ(save("s3", "two").code, "BUSY") << "robot2's layer is to come";
}

TEST_F(PlacementTest, UndoingAPlacementBringsBackTheOneBefore) {
  send_wall();
  ASSERT_TRUE(place("t1", at(1, 0)).ok);
  ASSERT_TRUE(place("t2", at(2, 0)).ok);
  run();
  const BrickMap at_two = node_->map();
  const Answer undone = undo("u2", "t2");
  ASSERT_TRUE(undone.ok) << undone.message;
  run();
  EXPECT_EQ(x_of_robot(), 1.0);
  EXPECT_EQ(undo("u3", "t2").code, "CONFLICT");
  EXPECT_TRUE(undo("u2", "t2").ok) << "the same once more";

  ASSERT_TRUE(undo("u1", "t1").ok);
  run();
  EXPECT_EQ(x_of_robot(), std::nullopt);
  EXPECT_TRUE(node_->map().empty()) << "nobody placed it: it waits outside";
  EXPECT_EQ(digest(heard_), digest(node_->map()));
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(undo("r2", "t2", true).ok);
    run();
    EXPECT_EQ(x_of_robot(), 2.0);
    EXPECT_EQ(node_->map(), at_two);
    start();
    agent_stream_->begin("frame1");
    run();
    EXPECT_EQ(x_of_robot(), 2.0) << "also after a restart";
  }
}

TEST_F(PlacementTest, HistoryTellsWhichPlacementsStand) {
  send_wall();
  ASSERT_TRUE(place("t1", at(1, 0)).ok);
  ASSERT_TRUE(place("t2", at(2, 0)).ok);
  ASSERT_TRUE(undo("u", "t2").ok);
  HistoryRequest all;
  all.id = "h1";
  ASSERT_TRUE(history(all).ok);
  ASSERT_EQ(histories_.size(), 1u);
  const auto& operations = histories_[0].operations;
  ASSERT_EQ(operations.size(), 3u);
  EXPECT_TRUE(operations[0].active);
  EXPECT_FALSE(operations[1].active);
  EXPECT_TRUE(operations[2].active);
}

TEST_F(PlacementTest, OfAFrameThatIsOverNothingCanBeUndone) {
  say_pose();
  ASSERT_TRUE(place("t1", at(1, 0)).ok);
  send_wall();  // it was carried over to the layer
  run();
  EXPECT_EQ(undo("u1", "t1").code, "CONFLICT");
  ASSERT_TRUE(undo("u2", "carried-1").ok);
  run();
  EXPECT_EQ(x_of_robot(), std::nullopt);
}

}  // namespace
}  // namespace concord
