// Robots: poses, paths, goals, virtual obstacles.

#include "bridge_test.hpp"

namespace concord::hmd {
namespace {

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

TEST_F(Working, APathSaysHowLongItTakesWhatItKeepsAwayFromAndHowFarOneGets) {
  EXPECT_CODE(ana.ask(ZoneAddRequest{"dock", ZoneKind::kNoGo, Frame::kMap, Box{{2.8, 0, 0}, {3.2, 0.6, 1}}}), "OK");
  lab.run(1);
  const Json goal = ana.ask(GoalRequest{"robot1", Frame::kMap, Pose{{5, 1, 0}, {0, 0, 0, 1}}});
  ASSERT_TRUE(has_code(goal, "OK"));
  const Json path = goal["answer"]["path"];
  EXPECT_NEAR(path["seconds"].get<double>() * lab.site.agent("robot1").speed, path["length"].get<double>(), 0.01);
  EXPECT_EQ(path["zones"], Json({"dock"}));
  EXPECT_FALSE(path.contains("nearest") || path.contains("failed_leg")) << path;
  EXPECT_CODE(ana.ask(PathRequest{"robot1", Frame::kMap, true}), "OK");
  EXPECT_CODE(ana.ask(add(box(3.4, -1, 0.1, 3.6, 7, 0.8))), "OK") << "from wall to wall";
  lab.run(3);
  ana.read();
  const Json cut = ana.events["path"]["path"];
  EXPECT_NE(cut["status"], "OK") << cut;
  EXPECT_EQ(cut["failed_leg"], 0) << cut;
  ASSERT_TRUE(cut.contains("nearest")) << cut;
  EXPECT_GT(cut["nearest"][0], 2.5) << "this side of the wall";
  EXPECT_LT(cut["nearest"][0], 3.4);
  EXPECT_FALSE(cut.contains("seconds"));
}

TEST_F(Working, APathIsSaidAnewInOnesOwnFrameWhenThatLiesElsewhere) {
  Client bert(lab);
  become_agent(bert, "headset1", true);  // a metre off along x
  EXPECT_CODE(bert.ask(PathRequest{"robot1", Frame::kOwn, true}), "OK");
  EXPECT_CODE(bert.ask(GoalRequest{"robot1", Frame::kMap, Pose{{5, 1, 0}, {0, 0, 0, 1}}}), "OK");
  lab.run(1.5);
  bert.read();
  const auto first_x = [&] { return bert.events.at("path")["path"]["points"][0]["p"][0].get<double>(); };
  const double before = first_x();
  EXPECT_CODE(ana.ask(PlaceRequest{"headset1", Pose{{1.5, 0, 0}, {0, 0, 0, 1}}}), "OK");
  lab.run(2.5);
  bert.read();
  EXPECT_NEAR(first_x(), before - 0.5, 0.01);
  bert.events.clear();
  lab.run(3);
  bert.read();
  EXPECT_FALSE(bert.events.contains("path")) << "nothing is new";
}

TEST_F(Working, GoalsThatCannotBeReachedAreRefused) {
  EXPECT_CODE(ana.ask(GoalRequest{"robot1", Frame::kMap, Pose{{50, 1, 0}, {0, 0, 0, 1}}}), "UNREACHABLE");
  EXPECT_CODE(ana.ask(GoalRequest{"nobody", Frame::kMap, kHere}), "NO_ROBOT");
  EXPECT_CODE(ana.ask(PlanRequest{"robot1", Frame::kMap, {}, {5, 1, 0}}), "OK");
  EXPECT_CODE(ana.ask(PlanRequest{"robot1", Frame::kMap, {}, {50, 1, 0}}), "UNREACHABLE");
}

TEST_F(Working, AWayFromNowhereIsRefusedByWhatIsMissing) {
  BrickMap seen;
  VoxelMask all;
  all.fill(~std::uint64_t{0});
  seen.set({0, 0, 0}, Brick::uniform(all, kOccupied));
  lab.agent_maps("robot2", seen);
  lab.run(0.5);
  const PlanRequest plan{"robot2", Frame::kMap, {}, {5, 1, 0}};
  EXPECT_CODE(ana.ask(plan), "UNALIGNED");
  EXPECT_CODE(ana.ask(PlaceRequest{"robot2", kHere}), "OK");
  lab.run(1.5);
  EXPECT_CODE(ana.ask(plan), "STALE") << "it never said where it is";
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
  EXPECT_EQ(ana.ask(PathRequest{"robot1", Frame::kMap, false})["answer"]["path"]["status"], "OK")
      << "it was taken back";
  const std::string obstacle = added["answer"]["obstacle"];
  EXPECT_CODE(ana.ask(ObstacleRemoveRequest{obstacle}), "OK");
  EXPECT_CODE(ana.ask(ObstacleRemoveRequest{obstacle}), "CONFLICT");
  EXPECT_CODE(ana.ask(ObstacleRemoveRequest{"none"}), "NOT_FOUND");
}

/// A planner that is too busy to look at the map says the old path again and again.
TEST_F(Working, AnObstacleOfWhichNoPlannerSaysWhatItDoesIsTakenBack) {
  concord::Path path;
  path.id = "old";
  path.robot = "robot1";
  path.active = true;
  path.status = "OK";
  const auto alive = std::make_shared<bool>(true);
  lab.bus->every(
      500'000, [&] { lab.bus->publish("out/path/robot1", encode(path)); }, alive);
  lab.run(1);
  EXPECT_CODE(ana.ask(ObstacleAddRequest{Frame::kMap, Box{{3, 0, 0.1}, {3.2, 3, 0.8}}, {}}), "TIMEOUT");
  lab.run(1);
  const Json map = ana.ask(SceneGetRequest{Frame::kMap, {3.1, 1.5, 0.5}, 0.3});
  EXPECT_TRUE(code_of_answer(map) == "OK" && map["answer"]["voxels"]["boxes"].empty()) << map;
}

/// A planner that says nothing any more has not ended its paths.
TEST_F(Working, AnObstacleAfterWhichThePlannerFallsSilentIsTakenBack) {
  concord::Path path;
  path.id = "old";
  path.robot = "robot1";
  path.active = true;
  path.status = "OK";
  lab.bus->publish("out/path/robot1", encode(path));
  lab.run(0.1);
  EXPECT_CODE(ana.ask(ObstacleAddRequest{Frame::kMap, Box{{3, 0, 0.1}, {3.2, 3, 0.8}}, {}}), "TIMEOUT");
}

TEST_F(Working, AnObstacleOfOneWhoHasGoneIsTakenBackAllTheSame) {
  EXPECT_CODE(ana.ask(GoalRequest{"robot1", Frame::kMap, Pose{{5, 1, 0}, {0, 0, 0, 1}}}), "OK");
  lab.run(1.5);
  const ObstacleAddRequest wall{Frame::kMap, Box{{3, -1, 0.1}, {3.2, 7, 0.8}}, {}};
  lab.bridge->hub().text(ana.connection, request_text(ana.next_id(), wall), lab.bus->now());
  ana.lose();
  lab.bridge->hub().tick(lab.bus->now() + 3600'000'000LL);  // the session is forgotten
  lab.run(4);
  Client bert(lab);
  ASSERT_TRUE(has_code(bert.hello(), "OK"));
  EXPECT_EQ(bert.ask(PathRequest{"robot1", Frame::kMap, false})["answer"]["path"]["status"], "OK");
}

TEST_F(Working, WhoFollowsAPathHearsThatNobodyKeepsItUp) {
  EXPECT_CODE(ana.ask(PathRequest{"robot1", Frame::kMap, true}), "OK");
  concord::Path path;
  path.id = "kept";
  path.robot = "robot1";
  path.active = true;
  path.status = "OK";
  lab.bus->publish("out/path/robot1", encode(path));
  lab.run(0.3);
  ana.read();
  ASSERT_EQ(ana.events["path"]["path"]["status"], "OK");
  lab.run(5);
  ana.read();
  EXPECT_EQ(ana.events["path"]["path"]["status"], "NO_PATH");
}

TEST_F(Working, WhoFollowsAPathHearsThatItHasEnded) {
  EXPECT_CODE(ana.ask(PathRequest{"robot1", Frame::kMap, true}), "OK");
  EXPECT_CODE(ana.ask(GoalRequest{"robot1", Frame::kMap, Pose{{5, 1, 0}, {0, 0, 0, 1}}}), "OK");
  lab.run(0.3);
  ana.read();
  ASSERT_EQ(ana.events["path"]["path"]["status"], "OK");
  concord::PathRequest cancel;
  cancel.id = "stop";
  cancel.robot = "robot1";
  cancel.op = concord::PathRequest::Op::kCancel;
  lab.bus->publish("in/path_request", encode(cancel, lab.bus->now()));
  lab.run(0.3);
  ana.read();
  EXPECT_EQ(ana.events["path"]["path"]["status"], "NO_PATH");
  EXPECT_TRUE(ana.events["path"]["path"]["points"].empty());
}

/// Merge and the planner, played by hand: what others change meanwhile does not pass for one's own obstacle.
class PlayedStack : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(code_of_answer(ana.hello()), "OK");
    sender_ = std::make_unique<BrickSender>(
        *lab.bus, lab.counters, BrickSender::Config{"out/map", lab.site.resolution, 5e6, lab.bus->now()}, map_);
    sender_->begin("map");
    lab.bus->subscribe("in/edit", [this](const std::string&, auto bytes) { asked_ = decode<EditOf>(bytes)->id; });
    say_edits(5);
    say_path();
  }
  using EditOf = concord::EditRequest;
  void change(int x) {
    map_.set({x, 0, 0}, Brick::uniform(first_voxel(), kPinnedOccupied));
    sender_->touch({x, 0, 0});
    lab.run(0.3);
  }
  static VoxelMask first_voxel() {
    VoxelMask mask{};
    mask[0] = 1;
    return mask;
  }
  void say_edits(std::int64_t correction) {
    lab.bus->publish("out/map_edits", encode(MapEdits{lab.bus->now(), boot_id_, correction, sender_->revision()}));
    lab.run(0.1);
  }
  void say_path() {
    concord::Path path;
    path.id = "old";
    path.robot = "robot2";
    path.active = true;
    path.status = "OK";
    path.map_revision = sender_->revision();
    lab.bus->publish("out/path/robot2", encode(path));
    lab.run(0.2);
  }
  /// Asks, and is answered by merge: it is correction 7.
  void add_obstacle() {
    id_ = ana.next_id();
    lab.bridge->hub().text(ana.connection,
                           request_text(id_, ObstacleAddRequest{Frame::kMap, Box{{3, 0, 0.1}, {3.2, 3, 0.8}}, {}}),
                           lab.bus->now());
    lab.run(0.1);
    ASSERT_FALSE(asked_.empty());
  }
  void grant() {
    answer(*lab.bus, {asked_, "merge", true, "OK", "pinned", 7, 12});
    lab.run(0.2);
  }
  bool answered() {
    ana.read();
    return ana.answers.contains(id_);
  }

  Lab lab{Lab::kWithoutMerge};
  Client ana{lab};
  BrickMap map_;
  std::unique_ptr<BrickSender> sender_;
  std::int64_t boot_id_ = 17;
  std::string asked_;
  std::int64_t id_ = 0;
};

TEST_F(PlayedStack, AnothersChangeDoesNotPassForTheObstacle) {
  add_obstacle();
  change(10);  // somebody else's
  say_edits(6);
  grant();
  say_path();  // planned on the map with that
  EXPECT_FALSE(answered()) << ana.answers[id_];
  change(4);
  say_edits(7);
  EXPECT_FALSE(answered()) << ana.answers[id_];
  change(11);
  say_path();
  ASSERT_TRUE(answered());
  EXPECT_CODE(ana.answers[id_], "OK");
}

TEST_F(PlayedStack, OfAMapThatBeginsAnewNobodyCanTellWhatHoldsTheObstacle) {
  add_obstacle();
  boot_id_ = 18;
  say_edits(7);
  grant();
  for (int i = 0; i < 12 && !answered(); ++i) {
    say_path();
    lab.run(0.4);
  }
  answer(*lab.bus, {asked_ + "-back", "merge", true, "OK", "undone", 8, 12});
  lab.run(0.2);
  ASSERT_TRUE(answered());
  EXPECT_CODE(ana.answers[id_], "TIMEOUT");
}

}  // namespace
}  // namespace concord::hmd
