#include "planner_station.hpp"

namespace concord {
namespace {

TEST_F(PlannerOnTheBus, StreamsTheGridOfTheMap) {
  start_planner(kStart);
  map_sender_.begin("map");
  run_seconds(3);
  EXPECT_TRUE(node_->map().synced());
  EXPECT_TRUE(grid_receiver_.synced());
  EXPECT_EQ(grid_.known_count(), 8U * 64U);
  EXPECT_TRUE(grid_ == node_->planner().grid().cells());
  set({1, 1, 0}, Brick());
  run_seconds(2);
  EXPECT_EQ(grid_.known_count(), 7U * 64U);
  map_ = BrickMap();
  map_sender_.begin("other");
  run_seconds(3);
  EXPECT_TRUE(grid_.empty());
}

TEST_F(PlannerOnTheBus, AnswersAndReplansWhenAWallIsBuilt) {
  start_with_zones();
  map_sender_.begin("map");
  run_seconds(2);
  ask("p1", Eigen::Vector2d(0.4, 0.8), true);
  ASSERT_EQ(paths_.size(), 1U);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(paths_[0].status, "OK");
  EXPECT_NEAR(paths_[0].length, 2.4, 1e-9);
  EXPECT_EQ(answers_[0].id, "p1");
  EXPECT_EQ(answers_[0].process, "planner");
  EXPECT_TRUE(answers_[0].ok);
  EXPECT_EQ(answers_[0].code, "OK");
  EXPECT_EQ(answers_[0].revision, map_sender_.revision());

  DenseBrick dense;
  dense.fill(kFree);
  dense[local_of(VoxelIndex{0, 7, 3})] = kPinnedOccupied;  // a post in the middle of the hall
  set({2, 0, 0}, Brick::from_dense(dense));
  run_seconds(1);
  ASSERT_EQ(paths_.size(), 2U);
  EXPECT_EQ(paths_[1].status, "OK");
  EXPECT_EQ(paths_[1].plan_number, 1);
  EXPECT_EQ(paths_[1].map_revision, map_sender_.revision());
  EXPECT_GT(paths_[1].length, 2.4);
  EXPECT_GE(paths_[1].least_clearance, 0.2 - 1e-6);
  EXPECT_EQ(answers_.size(), 1U);
}

TEST_F(PlannerOnTheBus, APathKnowsTheMapAsFarAsItIsWhole) {
  start_with_zones();
  map_sender_.begin("map");
  run_seconds(2);
  BrickDigest ahead{bus_.now(), map_sender_.boot_id(), "map", 0.1, map_sender_.revision() + 5, 8, 1, 0};
  bus_.publish("out/map/digest", encode(ahead));
  bus_.deliver();
  ask("p1", Eigen::Vector2d(0.4, 0.8), true);
  ASSERT_EQ(paths_.size(), 1U);
  EXPECT_EQ(paths_[0].map_revision, map_sender_.revision()) << "not of what was only announced";
}

TEST_F(PlannerOnTheBus, SaysAKeptPathEverySecondAndWhenItEnds) {
  start_with_zones();
  map_sender_.begin("map");
  run_seconds(2);
  ask("p1", Eigen::Vector2d(0.4, 0.8), true);
  DenseBrick corner;
  corner.fill(kFree);
  corner[local_of(VoxelIndex{7, 7, 3})] = kOccupied;
  set({3, 1, 0}, Brick::from_dense(corner));  // away from the path
  run_seconds(3.1);
  ASSERT_EQ(paths_.size(), 4U);
  EXPECT_EQ(paths_[3].id, "p1");
  EXPECT_EQ(paths_[3].points, paths_[0].points);
  EXPECT_GT(paths_[3].map_revision, paths_[0].map_revision);
  EXPECT_EQ(counters_.get("paths.OK"), 1);  // found once
  EXPECT_EQ(answers_.size(), 1U);
  ask("p2", Eigen::Vector2d(0.5, 0.8), true);
  ASSERT_EQ(paths_.size(), 6U);
  EXPECT_EQ(paths_[4].id, "p1");
  EXPECT_FALSE(paths_[4].active);
  EXPECT_EQ(paths_[5].id, "p2");
  EXPECT_TRUE(paths_[5].active);
}

TEST_F(PlannerOnTheBus, ForgetsWhereARobotIsThatIsNotAlignedAnyMore) {
  start_with_zones();
  map_sender_.begin("map");
  run_seconds(2);
  MapPose pose;
  pose.agent = "robot1";
  pose.T_map_base.translation() = Eigen::Vector3d(0.4, 0.8, 0);
  bus_.publish("out/pose/robot1", encode(pose));
  AgentState robot;
  robot.id = "robot1";
  robot.kind = "lidar";
  robot.frame_id = "odom";
  robot.aligned = true;
  bus_.publish("out/agents", encode(AgentList{bus_.now(), 0.1, {robot}}));
  ask("p1", std::nullopt, false);
  robot.aligned = false;
  bus_.publish("out/agents", encode(AgentList{bus_.now(), 0.1, {robot}}));
  ask("p2", std::nullopt, false);
  ASSERT_EQ(answers_.size(), 2U);
  EXPECT_EQ(answers_[0].code, "OK");
  EXPECT_EQ(answers_[1].code, "NO_POSE");
}

TEST_F(PlannerOnTheBus, SaysWhyThereIsNoPath) {
  start_with_zones();
  ask("p1", Eigen::Vector2d(0.4, 0.8), false);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_FALSE(answers_[0].ok);
  EXPECT_EQ(answers_[0].code, "NO_MAP");
  map_sender_.begin("map");
  run_seconds(2);
  ask("p2", std::nullopt, false);
  ASSERT_EQ(answers_.size(), 2U);
  EXPECT_EQ(answers_[1].code, "NO_POSE");
  MapPose pose;
  pose.agent = "robot1";
  pose.T_map_base.translation() = Eigen::Vector3d(0.4, 0.8, 0);
  bus_.publish("out/pose/robot1", encode(pose));
  ask("p3", std::nullopt, false);
  ASSERT_EQ(answers_.size(), 3U);
  EXPECT_EQ(answers_[2].code, "OK");
  ask("p3", std::nullopt, false);
  ASSERT_EQ(answers_.size(), 4U);
  EXPECT_EQ(paths_[3].points, paths_[2].points);
}

TEST_F(PlannerOnTheBus, ALatePlannerHasTheSameGrid) {
  start_planner(kStart);
  map_sender_.begin("map");
  run_seconds(2);
  const BrickMap before = grid_;
  EXPECT_FALSE(before.empty());

  LockstepBus other_bus(kStart);
  Counters other_counters;
  BrickSender sender(other_bus, other_counters, {.stream = "out/map", .resolution = 0.1, .boot_id = kStart}, map_);
  sender.begin("map");
  other_bus.advance_to(kStart + 5'000'000);
  const PlannerNode late({other_bus, other_counters, site_, "planner", kStart + 5'000'000}, std::launch::deferred);
  other_bus.advance_to(kStart + 9'000'000);
  EXPECT_TRUE(late.map().synced());
  EXPECT_TRUE(late.planner().grid().cells() == before);
}

TEST_F(PlannerOnTheBus, PlansNothingBeforeItKnowsTheZones) {
  start_planner(kStart);
  map_sender_.begin("map");
  run_seconds(2);
  ask("p1", Eigen::Vector2d(0.4, 0.8), true);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(answers_[0].code, "NO_ZONES");
  paths_.clear();
  say_zones({zone("press", Zone::Kind::kNoGo, {1.4, 0.6}, {1.6, 1.6})});
  run_seconds(1);
  ASSERT_FALSE(paths_.empty());
  EXPECT_EQ(paths_[0].status, "OK");
  EXPECT_GT(paths_[0].length, 2.41);
}

TEST_F(PlannerOnTheBus, AZoneTurnsARobotAsideAndSaysWhoCutItOff) {
  start_with_zones();
  map_sender_.begin("map");
  run_seconds(2);
  const BrickMap grid = grid_;
  ask("p1", Eigen::Vector2d(0.4, 0.8), true);
  ASSERT_EQ(paths_.size(), 1U);
  EXPECT_NEAR(paths_[0].length, 2.4, 1e-9);
  say_zones({zone("press", Zone::Kind::kNoGo, {1.4, 0.6}, {1.6, 1.6})});
  run_seconds(0.2);
  ASSERT_EQ(paths_.size(), 2U);
  EXPECT_EQ(paths_[1].status, "OK");
  EXPECT_EQ(paths_[1].plan_number, 1);
  EXPECT_GT(paths_[1].length, 2.41);
  EXPECT_GE(paths_[1].least_clearance, 0.2 - 1e-6);
  say_zones(
      {zone("gate", Zone::Kind::kNoGo, {1.8, -1}, {2, 3}), zone("press", Zone::Kind::kNoGo, {1.4, 0.6}, {1.6, 1.6})});
  run_seconds(0.2);
  ASSERT_EQ(paths_.size(), 3U);
  EXPECT_EQ(paths_[2].status, "NO_VALID_PATH");
  EXPECT_NE(paths_[2].message.find("'"), std::string::npos) << paths_[2].message;
  EXPECT_EQ(counters_.get("zones"), 2);
  paths_.clear();
  say_zones();
  run_seconds(1.5);  // a search that failed rests for a second
  ASSERT_FALSE(paths_.empty());
  EXPECT_EQ(paths_.back().status, "OK");
  EXPECT_EQ(paths_.back().plan_number, 3);
  EXPECT_NEAR(paths_.back().length, 2.4, 1e-9);
  EXPECT_TRUE(grid_ == grid);  // what was observed is what it was
  EXPECT_TRUE(node_->planner().grid().cells() == grid);
}

TEST_F(PlannerOnTheBus, AskingForAGoalInANoGoZoneIsAnsweredWithItsName) {
  start_planner(kStart);
  say_zones({zone("Schweißzelle 2", Zone::Kind::kNoGo, {2.6, 0}, {3.2, 1.6}),
             zone("dock", Zone::Kind::kAllowContact, {0, 0}, {3.2, 1.6})});
  map_sender_.begin("map");
  run_seconds(2);
  ask("p1", Eigen::Vector2d(0.4, 0.8), false);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(answers_[0].code, "GOAL_IN_NO_GO");
  EXPECT_NE(answers_[0].message.find("'Schweißzelle 2'"), std::string::npos) << answers_[0].message;
}

TEST_F(PlannerOnTheBus, ZonesAroundLabelledThingsHoldBesidePeoplesOwn) {
  ListSender<Zone> labels(bus_, counters_, "out/label_zones", 5e6);
  start_planner(kStart);
  map_sender_.begin("map");
  run_seconds(2);
  labels.set({zone("fork lift 2", Zone::Kind::kNoGo, {1.8, -1}, {2, 3})});
  run_seconds(0.2);
  ask("p1", Eigen::Vector2d(0.4, 0.8), false);
  EXPECT_EQ(answers_.back().code, "NO_ZONES");  // people's are still to come
  say_zones({zone("press", Zone::Kind::kNoGo, {1.4, 1.2}, {1.6, 1.6})});
  run_seconds(0.2);
  ask("p2", Eigen::Vector2d(0.4, 0.8), false);
  EXPECT_EQ(answers_.back().code, "NO_VALID_PATH");
  EXPECT_NE(answers_.back().message.find("'fork lift 2'"), std::string::npos) << answers_.back().message;
  labels.set({});
  run_seconds(0.2);
  ask("p3", Eigen::Vector2d(0.4, 0.8), false);
  EXPECT_EQ(answers_.back().code, "OK");
  EXPECT_EQ(counters_.get("zones"), 1);
}

TEST_F(PlannerOnTheBus, ALatePlannerHearsTheZonesThatWereSaidBefore) {
  say_zones({zone("gate", Zone::Kind::kNoGo, {1.8, -1}, {2, 3})});
  run_seconds(5);
  start_planner(kStart + 5'000'000);
  map_sender_.begin("map");
  run_seconds(3);
  EXPECT_TRUE(node_->zones().synced());
  ask("p1", Eigen::Vector2d(0.4, 0.8), false);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(answers_[0].code, "NO_VALID_PATH");
  EXPECT_NE(answers_[0].message.find("'gate'"), std::string::npos) << answers_[0].message;
}

TEST_F(PlannerOnTheBus, AZoneTooLargeToDrawStillHolds) {
  start_planner(kStart);
  map_sender_.begin("map");
  Zone plain = zone("plain", Zone::Kind::kNoGo, {1.8, -3e3}, {3e3, 3e3});
  say_zones({plain});
  run_seconds(2);
  EXPECT_EQ(counters_.get("zones_not_cell_by_cell"), 1);
  ask("p1", Eigen::Vector2d(0.4, 0.8), false);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(answers_[0].code, "GOAL_IN_NO_GO");
}

TEST_F(PlannerOnTheBus, RefusesABandWithoutVoxels) {
  site_.planner.zmax = site_.planner.zmin;
  EXPECT_THROW(start_planner(kStart), ConfigError);
}

TEST_F(PlannerOnTheBus, GarbageIsCountedAndNothingElse) {
  start_planner(kStart);
  for (const char* channel :
       {"in/path_request", "out/map/bricks", "out/map/digest", "out/pose/robot1", "out/zones", "out/zones/digest"}) {
    bus_.publish(channel, Bytes{1, 2, 3});
  }
  bus_.deliver();
  EXPECT_EQ(counters_.get("refused.in/path_request.MALFORMED"), 1);
  EXPECT_EQ(counters_.get("refused.out/map/bricks.MALFORMED"), 1);
  EXPECT_EQ(counters_.get("refused.out/zones.MALFORMED"), 1);
  EXPECT_TRUE(answers_.empty());
}

}  // namespace
}  // namespace concord
