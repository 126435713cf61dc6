#include "bus/lockstep_bus.hpp"

#include <gtest/gtest.h>

namespace concord::test {
namespace {

TEST(LockstepBusTest, timers_run_in_the_order_of_their_time_then_of_their_setting) {
  LockstepBus bus(1000);
  std::vector<std::pair<std::int64_t, char>> runs;
  const auto note = [&](char c) { return [&, c] { runs.emplace_back(bus.now(), c); }; };
  bus.every(30, note('a'));
  bus.every(20, note('b'));
  bus.every(30, note('c'));
  bus.advance_to(1060);
  using Runs = std::vector<std::pair<std::int64_t, char>>;
  EXPECT_EQ(runs, (Runs{{1020, 'b'}, {1030, 'a'}, {1030, 'c'}, {1040, 'b'}, {1060, 'a'}, {1060, 'b'}, {1060, 'c'}}));
  EXPECT_EQ(bus.now(), 1060);
  bus.advance_to(10);
  EXPECT_EQ(bus.now(), 1060) << "time never goes back";
}

TEST(LockstepBusTest, messages_are_delivered_in_the_order_of_publishing_whatever_handlers_do) {
  LockstepBus bus(0);
  std::vector<std::string> heard;
  bus.subscribe("a|b|c", [&](const std::string& channel, auto) {
    heard.push_back(channel);
    if (channel != "a") return;
    bus.publish("c", {});
    bus.subscribe("b", [&](const std::string&, auto) { heard.push_back("late"); });
  });
  bus.publish("a", {});
  bus.publish("b", {});
  bus.publish("abc", {});
  bus.deliver();
  EXPECT_EQ(heard, (std::vector<std::string>{"a", "b", "late", "c"}));
}

TEST(LockstepBusTest, what_a_timer_publishes_is_heard_at_its_time) {
  LockstepBus bus(0);
  std::vector<std::int64_t> times;
  bus.subscribe("tick", [&](const std::string&, auto) { times.push_back(bus.now()); });
  bus.every(10, [&] { bus.publish("tick", {}); });
  bus.advance_to(25);
  EXPECT_EQ(times, (std::vector<std::int64_t>{10, 20}));
}

TEST(LockstepBusTest, what_has_gone_is_forgotten_also_within_its_own_handler) {
  LockstepBus bus(0);
  int heard = 0, ran = 0;
  auto listener = std::make_shared<int>(), ticker = std::make_shared<int>();
  const auto captured = std::make_shared<int>();
  bus.subscribe(
      "a", [&, captured](const std::string&, auto) { heard += 1, listener.reset(); }, Bus::kQueued, listener);
  bus.every(
      10, [&, captured] { ran += 1, ticker.reset(); }, ticker);
  bus.publish("a", {});
  bus.publish("a", {});
  bus.advance_to(100);
  EXPECT_EQ(heard, 1);
  EXPECT_EQ(ran, 1);
  EXPECT_EQ(captured.use_count(), 1) << "the bus holds nothing of them any more";
}

}  // namespace
}  // namespace concord::test
