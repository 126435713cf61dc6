// What programs can ask of paths beside one, and what the planner bears.
#include <memory>

#include "planner_station.hpp"

namespace concord {
namespace {

TEST_F(PlannerOnTheBus, ACancelledPathEndsAndTheCancellerIsTold) {
  start_with_zones();
  map_sender_.begin("map");
  run_seconds(2);
  ask("p1", Eigen::Vector2d(0.4, 0.8), true);
  PathRequest cancel;
  cancel.id = "c1";
  cancel.robot = "robot1";
  cancel.op = PathRequest::Op::kCancel;
  for (int i = 0; i < 2; ++i) {
    bus_.publish("in/path_request", encode(cancel, bus_.now()));
    bus_.deliver();
  }
  ASSERT_EQ(paths_.size(), 2U);
  EXPECT_EQ(paths_[1].status, "CANCELLED");
  EXPECT_EQ(paths_[1].id, "p1");
  EXPECT_FALSE(paths_[1].active);
  ASSERT_EQ(answers_.size(), 3U);
  EXPECT_EQ(answers_[1].id, "c1");
  EXPECT_TRUE(answers_[1].ok);
  EXPECT_EQ(answers_[1].count, 1);
  EXPECT_TRUE(answers_[2].ok);
  EXPECT_EQ(answers_[2].count, 0);
  run_seconds(3);
  EXPECT_EQ(paths_.size(), 2U) << "nothing is said of it any more";
}

TEST_F(PlannerOnTheBus, APathIsSaidInTheFrameOfWhoWatchesIt) {
  start_with_zones();
  std::vector<Path> watched;
  listen<Path>(bus_, counters_, "test", "out/path_in/headset1",
               [&](const std::string&, const Path& path) { watched.push_back(path); });
  map_sender_.begin("map");
  run_seconds(2);
  ask("p1", Eigen::Vector2d(0.4, 0.8), true);
  const auto watch = [&](const std::string& id) {
    bus_.publish("in/path_watch", encode(PathWatch{id, "robot1", "headset1"}, bus_.now()));
    bus_.deliver();
  };
  watch("w1");
  ASSERT_EQ(answers_.size(), 2U);
  EXPECT_EQ(answers_[1].code, "NOT_ALIGNED");
  AgentState headset;
  headset.id = "headset1";
  headset.kind = "headset";
  headset.frame_id = "room";
  headset.aligned = true;
  headset.T_map_agent.translation() = Eigen::Vector3d(1, 0.5, 0);
  headset.T_map_agent.linear() = Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const auto say_agents = [&] {
    bus_.publish("out/agents", encode(AgentList{bus_.now(), 0.1, {headset}}));
    bus_.deliver();
  };
  say_agents();
  watch("w2");
  ASSERT_EQ(watched.size(), 1U) << "at once";
  const auto expect_same = [&](const Path& there) {
    ASSERT_EQ(there.points.size(), paths_.back().points.size());
    EXPECT_EQ(there.frame_agent, "headset1");
    EXPECT_EQ(there.frame_id, "room");
    EXPECT_EQ(there.path_id, paths_.back().path_id);
    for (std::size_t i = 0; i < there.points.size(); ++i) {
      EXPECT_LT((headset.T_map_agent * there.points[i] - paths_.back().points[i]).norm(), 1e-9);
    }
  };
  expect_same(watched.back());
  headset.T_map_agent.translation().x() = 1.3;
  say_agents();
  ASSERT_EQ(watched.size(), 2U) << "its frame has moved";
  expect_same(watched.back());
  say_zones({zone("press", Zone::Kind::kNoGo, {1.4, 0.6}, {1.6, 1.6})});
  run_seconds(0.2);
  ASSERT_EQ(watched.size(), 3U) << "the path has changed";
  expect_same(watched.back());
  run_seconds(40);
  const std::size_t heard = watched.size();
  EXPECT_GT(heard, 20U);
  run_seconds(5);
  EXPECT_EQ(watched.size(), heard) << "nobody has asked again for 30 s";
}

TEST_F(PlannerOnTheBus, TheEditThatCutsAPathOffIsAskedForAndNamed) {
  start_with_zones();
  map_sender_.begin("map");
  run_seconds(2);
  ask("p1", Eigen::Vector2d(0.4, 0.8), true);
  std::string asked;
  listen<HistoryRequest>(bus_, counters_, "test", "in/history_request",
                         [&](const std::string&, const HistoryRequest& request) { asked = request.id; });
  DenseBrick dense;
  dense.fill(kFree);
  for (int y = 0; y < 8; ++y) dense[local_of(VoxelIndex{0, y, 3})] = kPinnedOccupied;
  set({2, 0, 0}, Brick::from_dense(dense));
  set({2, 1, 0}, Brick::from_dense(dense));
  run_seconds(1);
  ASSERT_EQ(paths_.back().status, "BLOCKED_BY_EDIT") << paths_.back().message;
  ASSERT_FALSE(asked.empty());
  HistoryPart part;
  part.id = asked;
  part.operations.push_back({3, "e-1", "anna", 1, Operation::Kind::kAdd, "", 16, true, {16, 0, 3}, {16, 15, 3}});
  part.operations.push_back({4, "e-2", "anna", 1, Operation::Kind::kAdd, "", 16, true, {90, 0, 3}, {90, 15, 3}});
  part.operations.push_back({5, "e-3", "anna", 1, Operation::Kind::kAdd, "", 16, false, {16, 0, 3}, {16, 15, 3}});
  const std::size_t said = paths_.size();
  bus_.publish("out/history", encode(part, bus_.now()));
  bus_.deliver();
  ASSERT_EQ(paths_.size(), said + 1);
  EXPECT_EQ(paths_.back().edit_id, "e-1");
  EXPECT_NE(paths_.back().message.find("e-1 by anna"), std::string::npos) << paths_.back().message;
}

TEST_F(PlannerOnTheBus, OnAMapThatNobodySpeaksOfNothingNewIsPlanned) {
  LockstepBus bus(kStart);
  Counters counters;
  auto sender = std::make_unique<BrickSender>(
      bus, counters, BrickSender::Config{.stream = "out/map", .resolution = 0.1, .boot_id = kStart}, map_);
  ListSender<Zone> zones(bus, counters, "out/zones", 5e6);
  std::vector<Answer> answers;
  listen<Answer>(bus, counters, "test", kAnswers,
                 [&](const std::string&, const Answer& value) { answers.push_back(value); });
  const PlannerNode node({bus, counters, site_, "planner", kStart});
  zones.set({});
  sender->begin("map");
  const auto ask_after = [&](double seconds, const std::string& id) {
    bus.advance_to(bus.now() + static_cast<std::int64_t>(seconds * 1e6));
    PathRequest request;
    request.id = id;
    request.robot = "robot1";
    request.start = Eigen::Vector2d(0.4, 0.8);
    request.goal = {2.8, 0.8};
    bus.publish("in/path_request", encode(request, bus.now()));
    bus.deliver();
    return answers.back().code;
  };
  EXPECT_EQ(ask_after(3, "p1"), "OK");
  sender.reset();
  EXPECT_EQ(ask_after(5, "p2"), "OK");
  EXPECT_EQ(ask_after(10, "p3"), "MAP_STALE");
}

TEST_F(PlannerOnTheBus, TenThousandRequestsASecondAreAllAnswered) {
  start_with_zones();
  map_sender_.begin("map");
  run_seconds(2);
  for (int tick = 0; tick < 10; ++tick) {
    for (int i = 0; i < 1000; ++i) {
      PathRequest request;
      request.id = "p" + std::to_string(tick * 1000 + i);
      request.robot = "robot" + std::to_string(i % 7);
      request.start = Eigen::Vector2d(0.4, 0.8);
      request.goal = {2.8, 0.8};
      request.radius = 0.1 + 0.0001 * i;  // each of another size
      bus_.publish("in/path_request", encode(request, bus_.now()));
    }
    bus_.deliver();
    run_seconds(0.1);
  }
  run_seconds(60);
  EXPECT_EQ(answers_.size(), 10'000U);
  EXPECT_GT(counters_.get("paths.OK"), 1'000);
  EXPECT_EQ(counters_.get("paths.OK") + counters_.get("paths.BUSY"), 10'000);
}

}  // namespace
}  // namespace concord
