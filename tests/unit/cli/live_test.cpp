#include "cli/live.hpp"

#include <pwd.h>
#include <signal.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>

#include "cli/downsample.hpp"
#include "cli/end_request.hpp"
#include "cli/report.hpp"

namespace concord {
namespace {

/// A client that hears only itself: the test plays the stack on the client's own bus.
class LiveTest : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(site) << "lcm_url: memq://\n";
    common.site_file = site;
    common.timeout = 5.0;
  }
  void TearDown() override { std::filesystem::remove(site); }

  static TransformRequest request(const std::string& id) { return {id, "me", "robot1", "", Transform::Identity()}; }

  std::filesystem::path site =
      std::filesystem::path(testing::TempDir()) / ("live" + std::to_string(getpid()) + ".yaml");
  Common common;
};

TEST_F(LiveTest, AsksAgainUntilItIsAnswered) {
  Live live(common);
  const TransformRequest mine = request(live.new_id());
  int heard = 0;
  live.hear<TransformRequest>("in/transform", [&](const std::string&, const TransformRequest& asked) {
    if (++heard == 3) answer(live.bus(), {asked.id, "merge", true, "OK", "placed", 7, 0});
  });
  const auto answered = live.ask("in/transform", mine);
  ASSERT_TRUE(answered);
  EXPECT_EQ(heard, 3);
  EXPECT_EQ(answered->revision, 7);
}

TEST_F(LiveTest, ARefusalIsThreeAndCarriesTheReason) {
  Live live(common);
  const TransformRequest mine = request(live.new_id());
  live.hear<TransformRequest>("in/transform", [&](const std::string&, const TransformRequest& asked) {
    answer(live.bus(), {asked.id, "merge", false, "NO_AGENT", "no agent robot1", 0, 0});
  });
  const auto answered = live.ask("in/transform", mine);
  ASSERT_FALSE(answered);
  EXPECT_EQ(answered.error().exit, Exit::kRefused);
  EXPECT_EQ(answered.error().code, "NO_AGENT");
  EXPECT_EQ(answered.error().message, "merge: no agent robot1");
}

TEST_F(LiveTest, WhoIsBusyIsAskedAgain) {
  Live live(common);
  const TransformRequest mine = request(live.new_id());
  int heard = 0;
  live.hear<TransformRequest>("in/transform", [&](const std::string&, const TransformRequest& asked) {
    const bool ok = ++heard == 3;
    answer(live.bus(), {asked.id, "merge", ok, ok ? "OK" : "BUSY", "not now", 0, 0});
  });
  EXPECT_TRUE(live.ask("in/transform", mine));
  EXPECT_EQ(heard, 3);
}

TEST_F(LiveTest, AnIdThatAPersonGaveIsHeeded) {
  Live live(common);
  EXPECT_EQ(live.id_or_new("mine"), "mine");
  EXPECT_NE(live.id_or_new(""), "");
  int heard = 0;
  live.hear<TransformRequest>("in/transform", [&](const std::string&, const TransformRequest& asked) {
    answer(live.bus(), {asked.id, "merge", true, "OK", "", ++heard, 0});
  });
  EXPECT_EQ(live.ask("in/transform", request("mine"))->revision, 1);
  EXPECT_EQ(live.ask("in/transform", request("mine"))->revision, 2) << "not the answer of before";
}

TEST_F(LiveTest, AnAnswerToSomeoneElseIsNone) {
  common.timeout = 0.5;
  Live live(common);
  const TransformRequest mine = request(live.new_id());
  live.hear<TransformRequest>("in/transform", [&](const std::string&, const TransformRequest&) {
    answer(live.bus(), {"another", "merge", true, "OK", "", 0, 0});
  });
  const auto answered = live.ask("in/transform", mine);
  ASSERT_FALSE(answered);
  EXPECT_EQ(answered.error().exit, Exit::kNoAnswer);
}

TEST_F(LiveTest, NoTwoIdsAreEqualAndAllAreNames) {
  Live live(common), other(common);
  const std::string first = live.new_id(), second = live.new_id(), third = other.new_id();
  EXPECT_NE(first, second);
  EXPECT_NE(first, third);
  for (const std::string& id : {first, second, third}) EXPECT_TRUE(is_name(id)) << id;
}

TEST_F(LiveTest, WhatTheStackWouldRefuseUnreadIsNotAsked) {
  Live live(common);
  int heard = 0;
  live.hear<TransformRequest>("in/transform", [&](const std::string&, const TransformRequest&) { ++heard; });
  TransformRequest mine = request(live.new_id());
  mine.author = std::string(1000, 'x');
  const auto answered = live.ask("in/transform", mine);
  ASSERT_FALSE(answered);
  EXPECT_EQ(answered.error().exit, Exit::kUnusable);
  EXPECT_EQ(answered.error().code, "TOO_LARGE");
  EXPECT_NE(answered.error().message.find("at most 80"), std::string::npos) << answered.error().message;
  EXPECT_EQ(heard, 0);
}

TEST_F(LiveTest, MetresAreTheStacksWhateverTheSiteFileSays) {
  Live live(common);
  EXPECT_EQ(live.site().resolution, 0.05);
  live.bus().every(10'000, [&] { live.bus().publish("out/agents", encode(AgentList{1, 0.2, {}})); });
  ASSERT_TRUE(live.take_resolution());
  EXPECT_EQ(live.site().resolution, 0.2);
}

TEST_F(LiveTest, NobodyWhoSaysTheResolutionIsNoAnswer) {
  common.timeout = 0.2;
  Live live(common);
  const auto taken = live.take_resolution();
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().exit, Exit::kNoAnswer);
}

TEST_F(LiveTest, AnAuthorIsNeverJustAnybody) {
  setenv("USER", "Zoë", 1);
  EXPECT_EQ(author_or_user(""), "Zoë");
  EXPECT_EQ(author_or_user("tom"), "tom");
  setenv("USER", "a\nb", 1);
  EXPECT_NE(author_or_user(""), "a\nb");
  unsetenv("USER");
  const passwd* login = getpwuid(getuid());
  EXPECT_EQ(author_or_user(""), login != nullptr ? login->pw_name : "uid-" + std::to_string(getuid()));
}

TEST_F(LiveTest, KeepsTheLatestPathOfARequest) {
  Live live(common);
  PathRequest mine;
  mine.id = live.new_id();
  mine.robot = "robot1";
  live.hear<PathRequest>("in/path_request", [&](const std::string&, const PathRequest& asked) {
    Path path;
    path.id = asked.id;
    path.robot = asked.robot;
    path.status = "NO_VALID_PATH";
    live.bus().publish("out/path/robot1", encode(path));
    path.plan_number = 1;
    live.bus().publish("out/path/robot1", encode(path));
  });
  const auto path = request_path(live, mine);
  ASSERT_TRUE(path);
  EXPECT_EQ(path->status, "NO_VALID_PATH");
  EXPECT_TRUE(live.wait(5.0, [&] { return live.path_for(mine.id)->plan_number == 1; }));
}

TEST_F(LiveTest, CopiesAStreamWhole) {
  Live live(common);
  BrickMap map;
  VoxelMask all;
  all.fill(~std::uint64_t{0});
  for (std::int32_t x = 0; x < 100; ++x) map.set({x, 0, 0}, Brick::uniform(all, x % 2 == 0 ? kFree : kOccupied));
  BrickSender sender(live.bus(), live.counters(),
                     {.stream = "out/map", .resolution = live.site().resolution, .boot_id = live.bus().now()}, map);
  StreamCopy copy(live, "out/map");
  EXPECT_FALSE(copy.synced());
  sender.begin("map");
  ASSERT_TRUE(copy.wait_synced(live));
  EXPECT_EQ(copy.map(), map);
}

/// Why there is no submap of `agent` to wait for, when merge lists `listed` every now and then.
std::string why_no_submap(const Common& common, const std::string& agent, const std::vector<AgentState>& listed) {
  Live live(common);
  live.bus().every(20'000, [&] { live.bus().publish("out/agents", encode(AgentList{live.bus().now(), 0.1, listed})); });
  StreamCopy copy(live, "out/agent/" + agent);
  const auto synced = wait_for_submap(live, copy, agent);
  return synced ? "there is" : synced.error().code;
}

TEST_F(LiveTest, AnAgentThatMergeDoesNotListIsNotWaitedFor) {
  AgentState robot1;
  robot1.id = "robot1";
  robot1.frame_id = "odom";
  EXPECT_EQ(why_no_submap(common, "nobody", {}), "NO_AGENT");
  EXPECT_EQ(why_no_submap(common, "nobody", {robot1}), "NO_AGENT");
  EXPECT_EQ(why_no_submap(common, "robot1", {robot1}), "NO_MAP") << "it only says where it is";
  common.timeout = 0.3;
  robot1.revision = 7;
  EXPECT_EQ(why_no_submap(common, "robot1", {robot1}), "NO_ANSWER") << "it has one, but ingest does not speak";
}

TEST_F(LiveTest, TheSubmapOfAnAgentThatWasRemovedIsNone) {
  Live live(common);
  const BrickMap nothing;
  BrickSender sender(live.bus(), live.counters(),
                     {.stream = "out/agent/robot1", .resolution = live.site().resolution, .boot_id = live.bus().now()},
                     nothing);
  sender.end();
  StreamCopy copy(live, "out/agent/robot1");
  const auto synced = wait_for_submap(live, copy, "robot1");
  ASSERT_FALSE(synced);
  EXPECT_EQ(synced.error().code, "NO_AGENT");
}

Downsampled part_of(const DownsampleRequest& asked, std::int32_t part) {
  return {asked.id, asked.agent, "f", asked.resolution, part, 3, {Eigen::Vector3f(static_cast<float>(part), 0, 0)}};
}

TEST_F(LiveTest, ACloudThatIsOnItsWayIsNotAskedForAgain) {
  Live live(common);
  int asked = 0;
  std::int32_t sent = 0;
  const DownsampleRequest request{live.new_id(), "robot1", 0.5};
  live.hear<DownsampleRequest>("in/downsample", [&](const std::string&, const DownsampleRequest&) { ++asked; });
  live.bus().every(600'000, [&] {
    if (asked > 0 && sent < 3) live.bus().publish("out/downsampled", encode(part_of(request, sent++), 0));
  });
  const auto points = request_cloud(live, request);
  ASSERT_TRUE(points);
  EXPECT_EQ(points->size(), 3U);
  EXPECT_EQ(asked, 1);
}

TEST_F(LiveTest, ACloudOfWhichAPartWasLostIsAskedForAgain) {
  Live live(common);
  int asked = 0;
  live.hear<DownsampleRequest>("in/downsample", [&](const std::string&, const DownsampleRequest& heard) {
    for (std::int32_t part = asked++ == 0 ? 1 : 0; part < 3; ++part) {
      live.bus().publish("out/downsampled", encode(part_of(heard, part), 0));
    }
  });
  const auto points = request_cloud(live, {live.new_id(), "robot1", 0.5});
  ASSERT_TRUE(points);
  EXPECT_EQ(points->size(), 3U);
  EXPECT_EQ(asked, 2);
}

TEST_F(LiveTest, EveryWaitEndsWhenAPersonEndsTheProgram) {
  const auto interrupted = [&] {
    alarm(10);  // not a minute
    Live live(common);
    end_on_signals();
    live.bus().every(100'000, [] { raise(SIGINT); });
    const bool came = live.wait(60.0, [] { return false; }) || live.wait_while_moving(
                                                                   60.0, [] { return 0; }, [] { return false; });
    std::exit(came ? 1 : 0);
  };
  EXPECT_EXIT(interrupted(), testing::ExitedWithCode(0), "");
}

TEST_F(LiveTest, AStreamThatNobodySendsIsFive) {
  common.timeout = 0.2;
  Live live(common);
  StreamCopy copy(live, "out/map");
  const auto synced = copy.wait_synced(live);
  ASSERT_FALSE(synced);
  EXPECT_EQ(synced.error().exit, Exit::kNoAnswer);
}

}  // namespace
}  // namespace concord
