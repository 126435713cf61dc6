#include "bus/lcm_bus.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "bus/site.hpp"
#include "core/byte_stream.hpp"

namespace concord::test {
namespace {

class LcmBusTest : public testing::Test {
 protected:
  /// Serves until `happened`; the test's own time-out is the only one.
  template <class Happened>
  void spin_until(Happened happened) {
    while (!happened()) bus_.spin_once(10);
  }

  Counters counters_;
  LcmBus bus_{"memq://", counters_};
};

TEST_F(LcmBusTest, messages_come_whole_and_in_order) {
  std::vector<std::pair<std::string, Bytes>> heard;
  bus_.subscribe("in/[^/]+/bricks", [&](const std::string& channel, auto bytes) {
    heard.emplace_back(channel, Bytes(bytes.begin(), bytes.end()));
  });
  bus_.publish("in/a/bricks", Bytes{1});
  bus_.publish("in/a/b/bricks", Bytes{9});
  bus_.publish("in/a/bricks/x", Bytes{9});
  bus_.publish("in/b/bricks", Bytes{});
  spin_until([&] { return heard.size() == 2; });
  EXPECT_EQ(heard[0].first, "in/a/bricks");
  EXPECT_EQ(heard[0].second, Bytes{1});
  EXPECT_EQ(heard[1].first, "in/b/bricks");
  EXPECT_TRUE(heard[1].second.empty());
}

TEST_F(LcmBusTest, an_alternation_matches_whole_names) {
  int heard = 0;
  bool last = false;
  bus_.subscribe("in/a|in/b", [&](const std::string&, auto) { ++heard; });
  bus_.subscribe("last", [&](const std::string&, auto) { last = true; });
  for (const char* channel : {"in/a", "in/b", "in/abc", "x/in/b", "last"}) bus_.publish(channel, Bytes{});
  spin_until([&] { return last; });
  EXPECT_EQ(heard, 2);
}

TEST_F(LcmBusTest, an_exception_in_a_handler_is_counted_and_ends_nothing) {
  int heard = 0;
  bus_.subscribe("a", [&](const std::string&, auto) {
    if (++heard == 1) throw std::runtime_error("first");
    if (heard == 2) throw 2;
  });
  for (int i = 0; i < 3; ++i) bus_.publish("a", Bytes{});
  spin_until([&] { return heard == 3; });
  EXPECT_EQ(counters_.get("exceptions"), 2);
}

TEST_F(LcmBusTest, an_exception_in_a_timer_is_counted_and_ends_nothing) {
  int runs = 0;
  bus_.every(1000, [&] {
    ++runs;
    throw std::runtime_error("again");
  });
  spin_until([&] { return runs == 3; });
  EXPECT_EQ(counters_.get("exceptions"), 3);
}

TEST_F(LcmBusTest, timers_run_at_their_pace_though_messages_never_end) {
  int heard = 0;
  int runs = 0;
  bus_.subscribe("a", [&](const std::string&, auto) {
    ++heard;
    bus_.publish("a", Bytes{});
  });
  bus_.publish("a", Bytes{});
  bus_.every(2000, [&] { ++runs; });
  spin_until([&] { return runs == 5; });
  EXPECT_GT(heard, 5);
}

TEST_F(LcmBusTest, a_timer_that_was_held_up_runs_once_not_many_times) {
  int runs = 0;
  bool held_up = false;
  bus_.every(1000, [&] { ++runs; });
  bus_.subscribe("a", [&](const std::string&, auto) {
    const std::int64_t until = bus_.now() + 20'000;
    while (bus_.now() < until) {
    }
    held_up = true;
  });
  bus_.publish("a", Bytes{});
  spin_until([&] { return held_up; });
  EXPECT_LE(runs, 2);
}

TEST_F(LcmBusTest, timers_that_are_due_together_run_in_the_order_they_were_set) {
  std::vector<int> order;
  for (int i = 0; i < 3; ++i) bus_.every(1000, [&order, i] { order.push_back(i); });
  spin_until([&] { return order.size() >= 3; });
  EXPECT_EQ(std::vector<int>(order.begin(), order.begin() + 3), (std::vector<int>{0, 1, 2}));
}

TEST_F(LcmBusTest, a_handler_may_subscribe_and_set_timers) {
  bool heard = false;
  bool ran = false;
  bus_.subscribe("a", [&](const std::string&, auto) {
    bus_.subscribe("b", [&](const std::string&, auto) { heard = true; });
    bus_.every(1000, [&] { ran = true; });
    bus_.publish("b", Bytes{});
  });
  bus_.publish("a", Bytes{});
  spin_until([&] { return heard && ran; });
}

TEST_F(LcmBusTest, what_has_gone_is_forgotten_also_within_its_own_handler) {
  int heard = 0, ran = 0, last = 0;
  auto listener = std::make_shared<int>(), ticker = std::make_shared<int>();
  const auto captured = std::make_shared<int>();
  bus_.subscribe(
      "a", [&, captured](const std::string&, auto) { heard += 1, listener.reset(); }, Bus::kQueued, listener);
  bus_.subscribe("last", [&](const std::string&, auto) { ++last; });
  bus_.every(
      1000, [&, captured] { ran += 1, ticker.reset(); }, ticker);
  for (const char* channel : {"a", "a", "last"}) bus_.publish(channel, Bytes{});
  spin_until([&] { return last == 1 && ran == 1; });
  bus_.publish("a", Bytes{});
  bus_.publish("last", Bytes{});
  spin_until([&] { return last == 2 && captured.use_count() == 1; });
  EXPECT_EQ(heard, 1);
  EXPECT_EQ(ran, 1);
}

TEST_F(LcmBusTest, channel_names_that_are_not_printable_reach_nobody) {
  int heard = 0;
  bool last = false;
  bus_.subscribe("in/.*", [&](const std::string&, auto) { ++heard; });
  bus_.subscribe("last", [&](const std::string&, auto) { last = true; });
  bus_.publish("in/a\nb", Bytes{});
  bus_.publish("in/a\x1b[2J", Bytes{});
  bus_.publish("last", Bytes{});
  spin_until([&] { return last; });
  EXPECT_EQ(heard, 0);
}

TEST_F(LcmBusTest, time_never_goes_back) {
  std::int64_t before = bus_.now();
  for (int i = 0; i < 1000; ++i) {
    const std::int64_t time = bus_.now();
    ASSERT_GE(time, before);
    before = time;
  }
}

TEST(LcmBusUrl, one_that_cannot_be_joined_is_a_configuration_error) {
  Counters counters;
  EXPECT_THROW(LcmBus("nonsense://", counters), ConfigError);
  EXPECT_THROW(LcmBus("udpm://10.0.0.1:7667?ttl=0", counters), ConfigError);
}

TEST(CountersTest, refusals_of_hostile_names_are_bounded_and_push_nothing_else_out) {
  Counters counters;
  for (int i = 0; i < 10'000; ++i) counters.refused("in/x" + std::to_string(i), {Code::kMalformed, "bytes"});
  counters.set("agents", 3);
  EXPECT_LE(counters.all().size(), Counters::kMaxNames + 2);
  EXPECT_EQ(counters.get("refused.other"), 10'000 - static_cast<std::int64_t>(Counters::kMaxNames));
  EXPECT_EQ(counters.get("agents"), 3);
}

}  // namespace
}  // namespace concord::test
