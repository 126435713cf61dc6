#include "cli/live.hpp"

#include <unistd.h>

#include <fstream>

#include <gtest/gtest.h>

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
  const auto answered = live.ask("in/transform", encode(mine, 0), mine.id);
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
  const auto answered = live.ask("in/transform", encode(mine, 0), mine.id);
  ASSERT_FALSE(answered);
  EXPECT_EQ(answered.error().exit, Exit::kRefused);
  EXPECT_EQ(answered.error().code, "NO_AGENT");
  EXPECT_EQ(answered.error().message, "merge: no agent robot1");
}

TEST_F(LiveTest, AnAnswerToSomeoneElseIsNone) {
  common.timeout = 0.5;
  Live live(common);
  const TransformRequest mine = request(live.new_id());
  live.hear<TransformRequest>("in/transform", [&](const std::string&, const TransformRequest&) {
    answer(live.bus(), {"another", "merge", true, "OK", "", 0, 0});
  });
  const auto answered = live.ask("in/transform", encode(mine, 0), mine.id);
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
