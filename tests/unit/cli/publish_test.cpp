#include "cli/publish.hpp"

#include <unistd.h>

#include <fstream>

#include <gtest/gtest.h>

namespace concord {
namespace {

constexpr const char* kAgent = "robot1";

BrickMap row_of(LogOdds value) {
  BrickMap map;
  VoxelMask all;
  all.fill(~std::uint64_t{0});
  for (std::int32_t x = 0; x < 100; ++x) map.set({x, 0, 0}, Brick::uniform(all, value));
  return map;
}

/// The test plays ingest and merge on the client's own bus.
class PublishTest : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(site) << "lcm_url: memq://\n";
    common.site_file = site;
    live.emplace(common);
  }
  void TearDown() override { std::filesystem::remove(site); }

  void ingest_says(const std::string& frame, const BrickMap& map, std::int64_t revision) {
    live->bus().publish(std::string("out/agent/") + kAgent + "/digest",
                        encode(BrickDigest{live->bus().now(), 1, frame, live->site().resolution, revision,
                                           static_cast<std::int64_t>(map.brick_count()), digest(map)}));
  }
  void merge_says(const std::string& frame, const BrickMap& map, std::int64_t revision) {
    AgentState state;
    state.id = kAgent;
    state.frame_id = frame;
    state.known = static_cast<std::int64_t>(map.known_count());
    state.revision = revision;
    state.synced = true;
    live->bus().publish("out/agents", encode(AgentList{live->bus().now(), 0.1, {state}}));
  }
  void ingest_counts(const std::string& counter, std::int64_t count) {
    live->bus().publish("out/status/ingest", encode(ProcessStatus{live->bus().now(), "ingest", 1, {{counter, count}}}));
  }
  /// Whether it comes while everything said so far is handled.
  bool soon(const std::function<bool()>& done) { return live->wait(0.3, done); }

  std::filesystem::path site =
      std::filesystem::path(testing::TempDir()) / ("publish" + std::to_string(getpid()) + ".yaml");
  Common common;
  std::optional<Live> live;
};

TEST_F(PublishTest, AnOldMapOfAsManyVoxelsIsNotTheNewOne) {
  const BrickMap before = row_of(kFree), now = row_of(kOccupied);
  const PublishedMap published(*live, kAgent, "file", now);
  ingest_says("file", before, 100);
  merge_says("file", before, 100);
  EXPECT_FALSE(soon([&] { return published.arrived(); }));
  ingest_says("file", now, 200);
  EXPECT_FALSE(soon([&] { return published.arrived(); })) << "merge still holds the old one";
  merge_says("file", now, 200);
  EXPECT_TRUE(soon([&] { return published.arrived(); }));
}

TEST_F(PublishTest, TheSameMapInAnotherFrameHasNotArrived) {
  const BrickMap map = row_of(kOccupied);
  const Delivery delivery(*live, kAgent, "file", map);
  ingest_says("earlier", map, 100);
  merge_says("earlier", map, 100);
  EXPECT_FALSE(soon([&] { return delivery.arrived(); }));
}

TEST_F(PublishTest, HearsThatIngestRefusesItsFrame) {
  const Delivery delivery(*live, kAgent, "file", row_of(kOccupied));
  const auto heard = [&](std::int64_t refusals) { return soon([&] { return delivery.refusals() == refusals; }); };
  ingest_counts("refused.in/robot1/digest.BAD_FRAME", 7);  // may be of long ago
  ingest_counts("refused.in/robot10/digest.BAD_FRAME", 1);
  ingest_counts("refused.in/robot10/digest.BAD_FRAME", 2);
  ingest_counts("refused.in/robot1/digest.BAD_FRAME", 8);
  ASSERT_TRUE(heard(1));
  EXPECT_EQ(delivery.refusal(), "BAD_FRAME");
  ingest_counts("refused.in/robot1/digest.BAD_FRAME", 9);
  ASSERT_TRUE(heard(2));
  ingest_says("file", row_of(kFree), 100);
  EXPECT_TRUE(heard(0)) << "something came in after all";
}

TEST_F(PublishTest, HearsThatIngestCannotWrite) {
  const Delivery delivery(*live, kAgent, "file", row_of(kOccupied));
  ingest_counts("disk_fails", 1);
  EXPECT_TRUE(soon([&] { return delivery.disk_fails(); }));
  ingest_counts("disk_fails", 0);
  EXPECT_TRUE(soon([&] { return !delivery.disk_fails(); }));
}

TEST_F(PublishTest, WaitsAsLongAsSomethingMoves) {
  std::int64_t moves = 0;
  live->bus().every(100'000, [&] { moves += moves < 10 ? 1 : 0; });
  EXPECT_TRUE(live->wait_while_moving(
      0.5, [&] { return moves; }, [&] { return moves == 10; }));
  EXPECT_FALSE(live->wait_while_moving(
      0.2, [&] { return moves; }, [] { return false; }));
}

}  // namespace
}  // namespace concord
