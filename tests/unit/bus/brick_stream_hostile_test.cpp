// What a stream bears: packets that were never the sender's, more than fits, owners that change all they have.

#include <gtest/gtest.h>

#include "stream_world.hpp"

namespace concord::test {
namespace {

constexpr std::int64_t kSecond = StreamWorld::kSecond;

TEST(BrickStream, another_frame_in_the_same_epoch_is_refused) {
  StreamWorld world;
  Copy& copy = world.join();
  copy.receiver().on_digest({0, 100, "frame", kResolution, 0, 0, 0});
  copy.receiver().on_digest({0, 100, "other", kResolution, 0, 0, 0});
  EXPECT_EQ(copy.counters().get("refused." + kStream + ".BAD_FRAME"), 1);
  EXPECT_EQ(copy.receiver().frame_id(), "frame");
}

TEST(BrickStream, bricks_and_holes_are_bounded_and_holes_can_still_be_filled) {
  LockstepBus air(1'000'000);
  Copy small(air, {}, 1, 2);
  for (int i = 1; i <= 3; ++i) small.receiver().on_packet(packet_with(7, i, {i, 0, 0}, noisy_brick(1)));
  EXPECT_EQ(small.map().brick_count(), 2U);
  EXPECT_EQ(small.counters().get("refused." + kStream + "/bricks.TOO_LARGE"), 1);

  Copy holes(air, {}, 2);
  for (std::int64_t i = 1; i <= 70'000; ++i) holes.receiver().on_packet(packet(7, 2 * i, 2 * i));
  EXPECT_EQ(holes.counters().get("refused." + kStream + "/bricks.TOO_LARGE"), 70'000 - 65'536);
  holes.receiver().on_packet(packet_with(7, 1, {0, 0, 0}, noisy_brick(1)));
  EXPECT_EQ(holes.map().brick_count(), 1U);
}

TEST(BrickStream, a_copy_that_went_wrong_is_noticed_and_mended) {
  StreamWorld world;
  world.begin("frame");
  fill(world, 10);
  Copy& copy = world.join();
  ASSERT_GE(world.settle(5 * kSecond), 0);
  // Somebody else says something in the sender's name.
  std::int64_t boot_id = 0;
  world.air().subscribe(StreamChannels(kStream).digest,
                        [&](const std::string&, auto bytes) { boot_id = decode<BrickDigest>(bytes)->boot_id; });
  world.run(2 * kSecond);
  const std::int64_t next = world.sender().revision() + 1;
  copy.receiver().on_packet(packet_with(boot_id, next, {0, 0, 0}, noisy_brick(12345)));
  EXPECT_FALSE(copy.map() == world.map());
  world.set({9, 9, 9}, noisy_brick(4));
  world.set({9, 9, 9}, noisy_brick(5));
  EXPECT_GE(world.settle(5 * kSecond), 0);
  EXPECT_EQ(copy.counters().get("stream_mismatch." + kStream), 1);
}

BrickPacket of_this_epoch(BrickPacket forged, const StreamWorld& world) {
  forged.boot_id = world.boot_id();
  return forged;
}

TEST(BrickStreamHostile, a_packet_that_covers_everything_does_not_freeze_a_copy) {
  StreamWorld world;
  world.begin("frame");
  fill(world, 5);
  Copy& copy = world.join();
  ASSERT_GE(world.settle(5 * kSecond), 0);
  copy.receiver().on_packet(of_this_epoch(packet(0, 1, std::int64_t{1} << 59), world));
  for (int i = 0; i < 20; ++i) {
    world.set({i, 9, 0}, noisy_brick(100 + i));
    world.run(kSecond);
  }
  EXPECT_GE(world.settle(5 * kSecond), 0);
}

TEST(BrickStreamHostile, a_forged_brick_is_put_right_though_the_owner_changes_nothing) {
  StreamWorld world;
  world.begin("frame");
  fill(world, 5);
  Copy& copy = world.join();
  ASSERT_GE(world.settle(5 * kSecond), 0);
  const std::int64_t next = copy.receiver().revision() + 1;
  copy.receiver().on_packet(of_this_epoch(packet_with(0, next, {0, 0, 0}, noisy_brick(99)), world));
  copy.receiver().on_packet(of_this_epoch(packet_with(0, next + 1, {50, 0, 0}, noisy_brick(98)), world));
  EXPECT_GE(world.settle(10 * kSecond), 0);
}

TEST(BrickStreamHostile, a_forged_digest_is_corrected_by_the_next_one) {
  StreamWorld world;
  world.begin("frame");
  fill(world, 5);
  Copy& copy = world.join();
  ASSERT_GE(world.settle(5 * kSecond), 0);
  copy.receiver().on_digest({0, world.boot_id(), "frame", kResolution, std::int64_t{1} << 50, 1, 7});
  EXPECT_FALSE(copy.receiver().synced());
  EXPECT_GE(world.settle(10 * kSecond), 0);
}

TEST(BrickStreamHostile, a_full_copy_stops_asking_and_still_follows_what_it_has) {
  StreamWorld world;
  world.begin("frame");
  fill(world, 20);
  Copy small(world.air(), {}, 7, 300);
  world.run(5 * kSecond);
  EXPECT_FALSE(small.receiver().synced());
  const std::size_t asked = small.bytes_sent();
  world.run(60 * kSecond);
  EXPECT_EQ(small.bytes_sent(), asked);
  const BrickIndex held = small.map().sorted_bricks().front();
  world.set(held, noisy_brick(1234));
  world.run(2 * kSecond);
  EXPECT_EQ(*small.map().find(held), noisy_brick(1234));
}

TEST(BrickStreamHostile, an_owner_that_moves_on_does_not_pile_up_what_is_gone) {
  StreamWorld world;
  world.begin("frame");
  Copy follower(world.air(), {}, 3, 10'000);
  const auto place = [](int i) { return BrickIndex{i % 1000, i / 1000, 0}; };
  for (int i = 0; i < 30'000; ++i) {
    world.set(place(i), noisy_brick(static_cast<std::uint64_t>(i), 2));
    if (i >= 100) world.set(place(i - 100), Brick());
    if (i % 100 == 0) world.run(50'000);
  }
  Copy joiner(world.air(), {}, 5, 10'000);
  world.run(10 * kSecond);
  for (Copy* copy : {&follower, &joiner}) {
    EXPECT_TRUE(copy->receiver().synced());
    EXPECT_TRUE(copy->map() == world.map());
  }
}

TEST(BrickStreamHostile, senders_of_one_process_share_its_pace) {
  LockstepBus air(1'000'000);
  Counters counters;
  BrickMap map;
  for (int x = 0; x < 3000; ++x) map.set({x, 0, 0}, noisy_brick(static_cast<std::uint64_t>(x)));
  std::vector<std::unique_ptr<BrickSender>> senders;
  std::map<std::string, std::size_t> sent;
  air.subscribe(".*/bricks", [&](const std::string& channel, auto bytes) { sent[channel] += bytes.size(); });
  for (const char* stream : {"a", "b", "c"}) {
    const BrickSender::Config config{stream, kResolution, 3e5, air.now()};
    senders.push_back(std::make_unique<BrickSender>(air, counters, config, map));
    senders.back()->begin("frame");
    air.publish(StreamChannels(stream).need, encode(BrickRequest{config.boot_id, {{1, 3000}}}, air.now()));
  }
  air.advance_to(air.now() + 3 * kSecond);
  EXPECT_LE(sent["a/bricks"] + sent["b/bricks"] + sent["c/bricks"], 3 * 300'000U + 110'000U);
  for (const char* channel : {"a/bricks", "b/bricks", "c/bricks"}) EXPECT_GE(sent[channel], 100'000U) << channel;
}

TEST(BrickStreamHostile, another_incarnation_of_the_same_frame_is_not_the_same) {
  StreamWorld world;
  Copy& copy = world.join();
  BrickPacket first = packet_with(1, 1, {0, 0, 0}, noisy_brick(1));
  first.incarnation = 1;
  copy.receiver().on_packet(first);
  BrickPacket second = packet_with(2, 1, {1, 0, 0}, noisy_brick(2));
  second.incarnation = 2;
  copy.receiver().on_packet(second);
  EXPECT_EQ(copy.frames(), 2);
  EXPECT_EQ(copy.map().brick_count(), 1U);
  EXPECT_EQ(copy.receiver().incarnation(), 2);
}

}  // namespace
}  // namespace concord::test
