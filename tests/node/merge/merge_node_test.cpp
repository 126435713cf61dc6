#include "merge_station.hpp"

#include "core/octomap_reader.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

using MergeNodeTest = MergeStation;

TEST_F(MergeNodeTest, AnAgentWaitsOutsideUntilItIsAligned) {
  send_wall();
  EXPECT_TRUE(node_->map().empty());
  ASSERT_EQ(agents_.agents.size(), 1u);
  EXPECT_FALSE(agents_.agents[0].aligned);
  EXPECT_TRUE(agents_.agents[0].synced);
  EXPECT_EQ(agents_.agents[0].occupied, 8);

  Transform T = Transform::Identity();
  T.translation().z() = 0.8;
  EXPECT_TRUE(place("t1", T).ok);
  run();
  ASSERT_NE(node_->map().find(BrickIndex{2, 0, 1}), nullptr);
  EXPECT_EQ(digest(heard_), digest(node_->map())) << "what the planner hears is the map";
  EXPECT_TRUE(agents_.agents[0].aligned);
}

TEST_F(MergeNodeTest, WhatPeopleMadeOutlivesARestart) {
  send_wall();
  ASSERT_TRUE(place("t1", Transform::Identity()).ok);
  ASSERT_TRUE(add("e1", {100, 100, 1}).ok);
  run();
  const std::uint64_t before = digest(node_->map());
  start();
  EXPECT_TRUE(heard_.empty());
  agent_stream_->begin("frame1");
  run();
  EXPECT_EQ(digest(node_->map()), before);
  EXPECT_EQ(digest(heard_), before);
  EXPECT_EQ(add("e1", {100, 100, 1}).revision, 2) << "an edit sent again after the restart is the same edit";
}

TEST_F(MergeNodeTest, TheMapIsHeldBackUntilItIsWholeAgain) {
  send_wall();
  ASSERT_TRUE(place("t1", Transform::Identity()).ok);
  start();
  run(2'000'000);
  EXPECT_FALSE(listener_->heard()) << "robot1 was aligned and has not been heard yet";
  run(10'000'000);
  EXPECT_TRUE(listener_->heard()) << "but not for ever";
}

TEST_F(MergeNodeTest, AnEditSentTwiceIsOneEdit) {
  EXPECT_EQ(add("e1", {0, 0, 0}).revision, 1);
  EXPECT_EQ(add("e1", {0, 0, 0}).revision, 1);
  EXPECT_EQ(add("e2", {0, 0, 1}).revision, 2);
  run();
  EXPECT_EQ(node_->map().at({0, 0, 0}), kPinnedOccupied);
  EXPECT_EQ(heard_.known_count(), 2u);
}

TEST_F(MergeNodeTest, RefusesWhatCannotBe) {
  EXPECT_EQ(place("t1", Transform::Identity()).code, "NO_AGENT");
  send_wall();
  const Bytes other_frame =
      encode(TransformRequest{"t2", "eva", "robot1", "frame0", Transform::Identity()}, bus_->now());
  EXPECT_EQ(ask("in/transform", other_frame).code, "BAD_FRAME");
  EditRequest other_resolution = edit_of("e1", "eva", {0, 0, 0});
  std::get<VoxelList>(other_resolution.shape).resolution = 0.2;
  EXPECT_EQ(edit(other_resolution).code, "RES_MISMATCH");
  EXPECT_EQ(counters_.get("refused.in/edit.RES_MISMATCH"), 1);
  EXPECT_TRUE(ask("in/edit", Bytes(10, 7)).id.empty());
  EXPECT_EQ(counters_.get("refused.in/edit.MALFORMED"), 1);
}

TEST_F(MergeNodeTest, ANewFrameIsUnalignedAndLeavesNoGhost) {
  send_wall();
  ASSERT_TRUE(place("t1", Transform::Identity()).ok);
  run();
  ASSERT_FALSE(heard_.empty());
  agent_stream_->begin("frame2");
  run();
  EXPECT_TRUE(heard_.empty());
  EXPECT_FALSE(agents_.agents[0].aligned);
  agent_stream_->begin("frame1");
  run();
  EXPECT_FALSE(heard_.empty()) << "the transform of frame1 still holds";
}

TEST_F(MergeNodeTest, ARemovedAgentThatComesAgainIsNotWhereItWas) {
  send_wall();
  ASSERT_TRUE(place("t1", Transform::Identity()).ok);
  agent_stream_->end();
  run();
  EXPECT_TRUE(heard_.empty());
  EXPECT_TRUE(agents_.agents.empty());
  for (const bool restarted : {false, true}) {
    ++incarnation_;
    start();
    agent_stream_->begin("frame1");
    run();
    ASSERT_EQ(agents_.agents.size(), 1u) << restarted;
    EXPECT_FALSE(agents_.agents[0].aligned) << "its transform was for the one before";
  }
}

TEST_F(MergeNodeTest, AnEndThatNobodySaidTakesNothingFromPeople) {
  send_wall();
  ASSERT_TRUE(place("t1", Transform::Identity()).ok);
  bus_->publish("out/agent/robot1/digest", encode(BrickDigest{0, bus_->now() + 5, "", site_.resolution, 0, 0, 0, 1}));
  run(10'000'000);
  EXPECT_FALSE(heard_.empty()) << "the agent's stream goes on, and lies where it was put";
}

TEST_F(MergeNodeTest, AFullTableStillHasRoomForWhoIsInIt) {
  site_.ingest.max_agents = 1;
  start();
  send_wall();
  ASSERT_TRUE(place("t1", Transform::Identity()).ok);
  bus_->publish("in/robot9/pose", encode(AgentPose{"", "odom", Transform::Identity(), 5}));
  run();
  EXPECT_EQ(agents_.agents.size(), 1u);
  start();
  for (int i = 0; i < 70; ++i) {
    const std::string gone = "out/agent/gone" + std::to_string(i) + "/digest";
    bus_->publish(gone, encode(BrickDigest{0, bus_->now(), "", site_.resolution, 0, 0, 0, 1}));
  }
  agent_stream_->begin("frame1");
  run();
  EXPECT_FALSE(heard_.empty()) << "after a restart the map is still there";
}

TEST_F(MergeNodeTest, StrangersWhoSayNothingOfUseTakeNoRoom) {
  site_.ingest.max_agents = 1;
  start();
  for (int i = 0; i < 70; ++i) {
    const std::string stranger = "out/agent/stranger" + std::to_string(i) + "/digest";
    bus_->publish(stranger, encode(BrickDigest{0, bus_->now(), "frame1", 7 * site_.resolution, 0, 0, 0, 1}));
  }
  run();
  EXPECT_TRUE(agents_.agents.empty());
  EXPECT_LE(counters_.get("agents_without_frame"), 1);
  send_wall();
  ASSERT_EQ(agents_.agents.size(), 1u);
  EXPECT_EQ(agents_.agents[0].id, "robot1");
}

TEST_F(MergeNodeTest, AMapThatIsNotWholeYetIsNotSaved) {
  send_wall();
  ASSERT_TRUE(place("t1", Transform::Identity()).ok);
  start();
  const MapRequest save{"s1", MapRequest::Op::kSave, "hall", {"bt"}, true, ""};
  EXPECT_EQ(ask("in/map_request", encode(save, bus_->now())).code, "BUSY");
  agent_stream_->begin("frame1");
  run();
  EXPECT_TRUE(ask("in/map_request", encode(save, bus_->now())).ok) << "a refusal is not kept";
}

TEST_F(MergeNodeTest, AnIdBelongsToOneRequest) {
  send_wall();
  ASSERT_TRUE(place("one", Transform::Identity()).ok);
  ASSERT_TRUE(place("one", Transform::Identity()).ok);
  Transform other = Transform::Identity();
  other.translation().x() = 1;
  EXPECT_EQ(place("one", other).code, "EXISTS");
  const MapRequest save{"one", MapRequest::Op::kSave, "hall", {"bt"}, false, ""};
  EXPECT_EQ(ask("in/map_request", encode(save, bus_->now())).code, "EXISTS");
  ASSERT_TRUE(add("e1", {0, 0, 0}).ok);
  EXPECT_EQ(add("e1", {0, 0, 1}).code, "EXISTS");
}

TEST_F(MergeNodeTest, APlaceBeyondTheMapIsRefused) {
  send_wall();
  Transform far = Transform::Identity();
  far.translation().x() = 5000;
  EXPECT_EQ(place("t1", far).code, "OUT_OF_BOUNDS");
}

TEST_F(MergeNodeTest, ARobotWhoseClockWentBackIsHeardAfterASilence) {
  const auto say = [&](std::int64_t utime) {
    bus_->publish("in/robot2/pose", encode(AgentPose{"", "odom", Transform::Identity(), utime}));
    bus_->deliver();
  };
  say(1'000'000);
  ASSERT_TRUE(
      ask("in/transform", encode(TransformRequest{"t1", "eva", "robot2", "", Transform::Identity()}, bus_->now())).ok);
  poses_.clear();
  say(5);
  EXPECT_TRUE(poses_.empty());
  run(4'000'000);
  say(10);
  EXPECT_EQ(poses_.size(), 1u);
}

TEST_F(MergeNodeTest, ARobotThatSendsOnlyPosesIsAnAgent) {
  Transform T_agent_base = Transform::Identity();
  T_agent_base.translation().x() = 1;
  bus_->publish("in/robot2/pose", encode(AgentPose{"", "odom", T_agent_base, 5}));
  bus_->deliver();
  EXPECT_TRUE(poses_.empty()) << "not aligned yet";
  Transform T = Transform::Identity();
  T.translation().y() = 2;
  ASSERT_TRUE(ask("in/transform", encode(TransformRequest{"t1", "eva", "robot2", "", T}, bus_->now())).ok);
  ASSERT_EQ(poses_.size(), 1u);
  EXPECT_TRUE(poses_[0].T_map_base.translation().isApprox(Eigen::Vector3d(1, 2, 0)));
  bus_->publish("in/robot2/pose", encode(AgentPose{"", "odom", T_agent_base, 4}));
  bus_->deliver();
  EXPECT_EQ(counters_.get("refused.in/robot2/pose.STALE"), 1);
}

TEST_F(MergeNodeTest, SavesAndLists) {
  ASSERT_TRUE(add("e1", {0, 0, 0}).ok);
  const MapRequest save{"s1", MapRequest::Op::kSave, "hall", {"bt"}, false, ""};
  EXPECT_TRUE(ask("in/map_request", encode(save, bus_->now())).ok);
  const MapRequest again{"s2", MapRequest::Op::kSave, "hall", {"bt"}, false, ""};
  EXPECT_EQ(ask("in/map_request", encode(again, bus_->now())).code, "EXISTS");
  EXPECT_TRUE(ask("in/map_request", encode(save, bus_->now())).ok) << "the same request is answered as before";
  EXPECT_TRUE(
      ask("in/map_request", encode(MapRequest{"l1", MapRequest::Op::kList, "", {}, false, ""}, bus_->now())).ok);
  ASSERT_EQ(list_.files.size(), 1u);
  EXPECT_EQ(list_.files[0].first, "hall.bt");
  const auto bytes = read_whole_file(site_.state / "maps/hall.bt", 10'000);
  ASSERT_TRUE(bytes);
  EXPECT_EQ(read_octomap_file(*bytes, std::nullopt)->map.occupied_count(), 1u);
}

TEST_F(MergeNodeTest, SavesAllFormatsOfARequestOrNone) {
  ASSERT_TRUE(add("e1", {0, 0, 0}).ok);
  MapRequest save{"s1", MapRequest::Op::kSave, "hall", {"bt"}, false, ""};
  ASSERT_TRUE(ask("in/map_request", encode(save, bus_->now())).ok);
  save = {"s2", MapRequest::Op::kSave, "hall", {"ot", "bt"}, false, ""};
  EXPECT_EQ(ask("in/map_request", encode(save, bus_->now())).code, "EXISTS");
  EXPECT_FALSE(std::filesystem::exists(site_.state / "maps/hall.ot")) << "a refused request changes nothing";
  save = {"s3", MapRequest::Op::kSave, "hall", {"ot", "bt"}, true, ""};
  const Answer saved = ask("in/map_request", encode(save, bus_->now()));
  EXPECT_TRUE(saved.ok);
  const auto written = read_whole_file(site_.state / "maps/hall.ot", 10'000);
  ASSERT_TRUE(written);
  EXPECT_EQ(saved.content, digest(read_octomap_file(*written, std::nullopt)->map)) << "of what was written";
  ASSERT_EQ(saved.parts.size(), 2u);
  EXPECT_EQ(saved.parts[0], static_cast<std::int64_t>(written->size()));
  EXPECT_EQ(saved.count, saved.parts[0] + saved.parts[1]);
}

TEST_F(MergeNodeTest, AMapOfAnotherResolutionIsNotOpened) {
  ASSERT_TRUE(add("e1", {0, 0, 0}).ok);
  node_.reset();
  Site finer = site_;
  finer.resolution = 0.05;
  EXPECT_THROW(MergeNode({*bus_, counters_, finer, "merge", bus_->now()}), std::runtime_error);
}

}  // namespace
}  // namespace concord
