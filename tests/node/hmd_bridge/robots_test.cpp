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

}  // namespace
}  // namespace concord::hmd
