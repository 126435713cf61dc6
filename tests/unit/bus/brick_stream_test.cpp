#include <gtest/gtest.h>

#include "stream_world.hpp"

namespace concord::test {
namespace {

constexpr std::int64_t kSecond = StreamWorld::kSecond;

TEST(BrickStream, nothing_is_in_sync_before_a_digest_says_how_much_there_is) {
  StreamWorld world;
  Copy& copy = world.join();
  EXPECT_FALSE(copy.receiver().synced());
  copy.receiver().on_packet(packet_with(1, 1, {0, 0, 0}, noisy_brick(1)));
  EXPECT_TRUE(copy.receiver().heard());
  EXPECT_FALSE(copy.receiver().synced());
}

TEST(BrickStream, an_empty_map_is_in_sync) {
  StreamWorld world;
  world.begin("frame");
  Copy& copy = world.join();
  EXPECT_GE(world.settle(2 * kSecond), 0);
  EXPECT_EQ(copy.frames(), 1);
}

TEST(BrickStream, a_restarted_sender_with_the_same_map_takes_nothing_away_meanwhile) {
  StreamWorld world;
  world.begin("frame");
  fill(world, 30);
  Copy& copy = world.join();
  ASSERT_GE(world.settle(5 * kSecond), 0);
  const int changes = copy.changes();
  const std::size_t bytes = world.bytes_sent();
  world.restart_sender();
  ASSERT_GE(world.settle(5 * kSecond), 0);
  EXPECT_EQ(copy.changes(), changes);
  EXPECT_EQ(copy.frames(), 1);
  EXPECT_LT(world.bytes_sent() - bytes, 1000U) << "a digest says that nothing needs to be sent";
}

TEST(BrickStream, a_restarted_sender_with_another_map_only_takes_away_what_is_gone) {
  StreamWorld world;
  world.begin("frame");
  fill(world, 30);
  Copy& copy = world.join();
  ASSERT_GE(world.settle(5 * kSecond), 0);
  const int changes = copy.changes();
  for (int x = 0; x < 10; ++x) world.set({x, 3, 0}, Brick());
  world.set({5, 5, 0}, noisy_brick(77));
  world.restart_sender();
  ASSERT_GE(world.settle(5 * kSecond), 0);
  EXPECT_EQ(copy.changes(), changes + 11);
  EXPECT_GE(copy.map().brick_count(), 890U);
}

TEST(BrickStream, what_was_on_disk_is_confirmed_by_a_digest_alone) {
  StreamWorld world;
  world.begin("frame");
  fill(world, 30);
  world.join();
  ASSERT_GE(world.settle(5 * kSecond), 0);
  const std::size_t bytes = world.bytes_sent();
  world.restart_copy(0, true);
  ASSERT_GE(world.settle(2 * kSecond), 0);
  EXPECT_EQ(world.copies()[0]->changes(), 0);
  EXPECT_LT(world.bytes_sent() - bytes, 1000U);
}

TEST(BrickStream, an_older_version_does_not_replace_a_newer_one) {
  StreamWorld world;
  Copy& copy = world.join();
  copy.receiver().on_packet(packet_with(1, 9, {0, 0, 0}, noisy_brick(2)));
  copy.receiver().on_packet(packet_with(1, 5, {0, 0, 0}, noisy_brick(1)));
  copy.receiver().on_packet(packet_with(1, 6, {0, 0, 0}, Brick()));
  EXPECT_EQ(*copy.map().find(BrickIndex{0, 0, 0}), noisy_brick(2));
  EXPECT_EQ(copy.changes(), 1);
}

TEST(BrickStream, an_old_packet_does_not_undo_what_a_digest_confirmed) {
  StreamWorld world;
  Copy& copy = world.join();
  BrickMap map;
  map.set({0, 0, 0}, noisy_brick(2));
  copy.receiver().adopt("frame", map);
  copy.receiver().on_digest({0, 1, "frame", kResolution, 9, 1, digest(map)});
  ASSERT_TRUE(copy.receiver().synced());
  copy.receiver().on_packet(packet_with(1, 5, {0, 0, 0}, noisy_brick(1)));
  EXPECT_EQ(copy.changes(), 0);
}

TEST(BrickStream, an_ended_stream_is_said_once_and_may_begin_again) {
  StreamWorld world;
  world.begin("frame");
  fill(world, 3);
  Copy& copy = world.join();
  ASSERT_GE(world.settle(5 * kSecond), 0);
  world.end();
  world.run(3 * kSecond);
  EXPECT_EQ(copy.ends(), 1);
  EXPECT_TRUE(copy.map().empty());
  world.begin("frame");
  EXPECT_GE(world.settle(5 * kSecond), 0);
  EXPECT_EQ(copy.frames(), 2);
}

TEST(BrickStream, a_closed_frame_stays_out_through_restarts_of_the_sender) {
  StreamWorld world;
  world.begin("frame");
  fill(world, 3);
  Copy& copy = world.join();
  ASSERT_GE(world.settle(5 * kSecond), 0);
  const int changes = copy.changes();
  copy.receiver().close_frame();
  world.set({0, 0, 0}, Brick());
  world.run(2 * kSecond);
  world.restart_sender();
  world.run(2 * kSecond);
  EXPECT_EQ(copy.changes(), changes);
  EXPECT_EQ(copy.frames(), 1);
  world.begin("another");
  world.run(2 * kSecond);
  EXPECT_EQ(copy.frames(), 2);
  EXPECT_EQ(copy.map().brick_count(), 8U);
}

TEST(BrickStream, loss_costs_bytes_and_time_in_proportion) {
  const struct {
    std::uint32_t lost;
    double most_bytes;  // of what one pass takes
    std::int64_t most_time;
  } cases[] = {{0, 1.01, 1'000'000}, {1, 1.10, 1'500'000}, {5, 1.35, 2'500'000}, {20, 2.3, 5'000'000}};
  std::size_t pass = 0;
  for (const auto& [lost, most_bytes, most_time] : cases) {
    StreamWorld world({lost, 0, 0});
    fill(world, 60);
    world.begin("frame");
    for (int i = 0; i < 3; ++i) world.join();
    const std::int64_t time = world.settle(20 * kSecond);
    if (pass == 0) pass = world.bytes_sent();
    RecordProperty("ms_" + std::to_string(lost), static_cast<int>(time / 1000));
    RecordProperty("percent_of_a_pass_" + std::to_string(lost), static_cast<int>(world.bytes_sent() * 100 / pass));
    EXPECT_GE(time, 0) << lost;
    EXPECT_LE(time, most_time) << lost;
    EXPECT_LE(static_cast<double>(world.bytes_sent()), most_bytes * static_cast<double>(pass)) << lost;
  }
}

TEST(BrickStream, a_joiner_does_not_hold_up_what_is_new) {
  StreamWorld world({}, 1e6);
  world.begin("frame");
  fill(world, 60);
  Copy& first = world.join();
  ASSERT_GE(world.settle(20 * kSecond), 0);
  Copy& joiner = world.join();
  world.run(kSecond / 2);
  ASSERT_FALSE(joiner.receiver().synced());
  world.set({1000, 0, 0}, noisy_brick(3));
  world.run(20'000);
  EXPECT_NE(first.map().find(BrickIndex{1000, 0, 0}), nullptr);
  EXPECT_FALSE(joiner.receiver().synced());
  EXPECT_GE(world.settle(20 * kSecond), 0);
}

TEST(BrickStream, a_joiner_is_served_though_the_sender_always_has_something_new) {
  StreamWorld world({}, 1e6);
  world.begin("frame");
  fill(world, 30);
  world.run(5 * kSecond);
  Copy& joiner = world.join();
  for (int i = 0; i < 1000; ++i) {
    for (int k = 0; k < 20; ++k) world.set({2000 + (i * 20 + k) % 3000, 0, 0}, noisy_brick(i));
    world.run(10'000);
  }
  EXPECT_NE(joiner.map().find(BrickIndex{0, 0, 0}), nullptr);
}

TEST(BrickStream, pace_is_kept) {
  StreamWorld world({}, 2e5);
  world.begin("frame");
  fill(world, 40);
  world.run(2 * kSecond);
  EXPECT_FALSE(world.sender().idle());
  EXPECT_LE(world.bytes_sent(), 2 * 200'000U + 105'000U);
  EXPECT_GE(world.bytes_sent(), 2 * 180'000U);
}

TEST(BrickStream, an_idle_stream_costs_little) {
  StreamWorld world;
  world.begin("frame");
  fill(world, 70);  // 4,900 bricks of 400 to 512 known voxels: about 2 million
  for (int x = 0; x < 70; ++x) {
    for (int y = 0; y < 70; ++y) world.set({x, y, 0}, noisy_brick(static_cast<std::uint64_t>(x * 70 + y), 90));
  }
  ASSERT_GE(world.map().known_count(), 2'000'000U);
  for (int i = 0; i < 3; ++i) world.join();
  ASSERT_GE(world.settle(60 * kSecond), 0);
  world.run(kSecond);
  const auto all_bytes = [&] {
    std::size_t sum = world.bytes_sent();
    for (const auto& copy : world.copies()) sum += copy->bytes_sent();
    return sum;
  };
  const std::size_t before = all_bytes();
  world.run(10 * kSecond);
  const std::size_t per_second = (all_bytes() - before) / 10;
  RecordProperty("bytes_per_second", static_cast<int>(per_second));
  EXPECT_LE(per_second, 1000U);
}

TEST(BrickStream, one_percent_changed_costs_at_most_three_percent) {
  StreamWorld world;
  for (int i = 0; i < 1000; ++i) world.set({i % 100, i / 100, 0}, noisy_brick(i, 15));
  world.begin("frame");
  world.join();
  ASSERT_GE(world.settle(20 * kSecond), 0);
  const std::size_t full = world.bytes_sent();
  for (int i = 500; i < 510; ++i) world.set({i % 100, i / 100, 0}, noisy_brick(i + 9999, 15));
  ASSERT_GE(world.settle(20 * kSecond), 0);
  world.run(100'000);
  EXPECT_LE((world.bytes_sent() - full) * 100, full * 3);
}

TEST(BrickStream, a_brick_touched_without_a_change_is_not_sent) {
  StreamWorld world;
  world.begin("frame");
  fill(world, 3);
  const std::int64_t revision = world.sender().revision();
  world.sender().touch({0, 0, 0});
  world.sender().touch({50, 50, 50});
  EXPECT_EQ(world.sender().revision(), revision);
}

TEST(BrickStream, a_trickle_of_changes_is_not_doubled_by_digests) {
  StreamWorld world;
  world.begin("frame");
  int digests = 0;
  world.air().subscribe(StreamChannels(kStream).digest, [&](const std::string&, auto) { ++digests; });
  for (int i = 0; i < 1000; ++i) {
    world.set({i, 0, 0}, noisy_brick(1));
    world.run(10'000);
  }
  EXPECT_LE(digests, 210);
}

TEST(BrickStream, an_earlier_start_of_the_sender_is_refused_until_the_later_one_is_silent) {
  StreamWorld world;
  Copy& copy = world.join();
  const BrickMap empty;
  copy.receiver().on_digest({0, 100, "frame", kResolution, 0, 0, 0});
  copy.receiver().on_packet(packet_with(99, 1, {0, 0, 0}, noisy_brick(1)));
  EXPECT_EQ(copy.counters().get("refused." + kStream + ".STALE"), 1);
  EXPECT_TRUE(copy.map().empty());
  EXPECT_TRUE(copy.receiver().synced());

  world.run(3 * kSecond);
  copy.receiver().on_packet(packet_with(99, 1, {0, 0, 0}, noisy_brick(1)));
  EXPECT_EQ(copy.map().brick_count(), 1U);
}

TEST(BrickStream, what_does_not_fit_is_refused_and_changes_nothing) {
  StreamWorld world;
  world.begin("frame");
  fill(world, 3);
  Copy& copy = world.join();
  ASSERT_GE(world.settle(5 * kSecond), 0);
  const std::int64_t boot_id = world.air().now() * 2;
  const int changes = copy.changes();

  BrickPacket wrong = packet_with(boot_id, 1, {0, 0, 0}, noisy_brick(1));
  wrong.resolution = 0.1;
  copy.receiver().on_packet(wrong);
  EXPECT_EQ(copy.counters().get("refused." + kStream + ".RES_MISMATCH"), 1);

  wrong = packet_with(boot_id, 1, {0, 0, 0}, noisy_brick(1));
  wrong.count = 2;
  copy.receiver().on_packet(wrong);
  wrong.count = 0;
  copy.receiver().on_packet(wrong);
  wrong.count = INT32_MAX;
  copy.receiver().on_packet(wrong);
  wrong = packet_with(boot_id, 1, {0, 0, 0}, noisy_brick(1));
  wrong.data.back() ^= 0xFF;
  wrong.data.resize(wrong.data.size() - 1);
  copy.receiver().on_packet(wrong);
  EXPECT_EQ(copy.counters().get("refused." + kStream + "/bricks.MALFORMED"), 4);

  copy.receiver().on_packet(packet_with(boot_id, 1, {1 << 17, 0, 0}, noisy_brick(1)));
  EXPECT_EQ(copy.counters().get("refused." + kStream + "/bricks.OUT_OF_BOUNDS"), 1);

  EXPECT_TRUE(world.settled());
  EXPECT_EQ(copy.changes(), changes);
}

}  // namespace
}  // namespace concord::test
