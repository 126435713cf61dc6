#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/brick.hpp"
#include "noise.hpp"
#include "stack_fixture.hpp"

// The real processes on hosts of their own. One agent under the identity makes the map equal to what it sends, so every
// test compares a consumer's copy of the map with the robot's own bricks, to the byte.

namespace concord::test {
namespace {

constexpr double kResolution = 0.05;
constexpr int kLossPerMille = 50;
const std::string kIdentity = "\"0 0 0 0 0 0 1\"";

class StackSystemTest : public StackFixture {
 protected:
  /// Who listens from now on; what it holds afterwards is what the stack has said to a late joiner.
  void listen_to_map(const Host& host) { map_ = std::make_unique<StreamCopy>(host, "out/map", kResolution); }
  void add_robot(const Host& host, BrickMap map) {
    robot_ = std::make_unique<StreamSource>(host, "in/robot1", kResolution, std::move(map));
  }

  [[nodiscard]] bool happens(const std::function<bool()>& event) {
    std::vector<LcmBus*> buses = {&ear_->bus()};
    if (robot_) buses.push_back(&robot_->bus());
    if (map_) buses.push_back(&map_->bus());
    return eventually(buses, event);
  }
  [[nodiscard]] bool robot_is_known() {
    return happens([this] { return !agents_.empty() && agents_.front().id == "robot1"; });
  }
  [[nodiscard]] bool map_becomes(const BrickMap& expected) {
    return happens([&] {
      return map_->synced() && map_->map().brick_count() == expected.brick_count() && map_->map() == expected;
    });
  }
  void align() const { stack_->concord(*person_, "set-transform robot1 " + kIdentity); }

  std::unique_ptr<StreamCopy> map_;
  std::unique_ptr<StreamSource> robot_;
};

TEST_F(StackSystemTest, a_submap_becomes_the_map_over_a_lossy_network) {
  Host& robot = network().add("robot1");
  const Host* const lossy[] = {&robot, person_, &stack_->host("ingest"), &stack_->host("merge")};
  for (const Host* host : lossy) host->lose_arriving(kLossPerMille);
  stack_->start_all();
  listen_to_map(*person_);
  add_robot(robot, noisy_map(40, 1));
  ASSERT_TRUE(robot_is_known());
  align();
  ASSERT_TRUE(map_becomes(robot_->map()));

  std::uint32_t seed = 7;
  for (int x = 0; x < 16; ++x) robot_->set({x, 3, 0}, Brick::from_dense(noise(seed)));
  robot_->set({30, 3, 0}, Brick());
  EXPECT_TRUE(map_becomes(robot_->map()));
  for (const char* process : {"ingest", "merge"}) EXPECT_GT(stack_->host(process).lost(), 20) << process;
}

TEST_F(StackSystemTest, processes_killed_under_way_lose_nothing) {
  stack_->start_all();
  listen_to_map(*person_);
  add_robot(network().add("robot1"), noisy_map(64, 2));
  ASSERT_TRUE(robot_is_known());
  align();
  ASSERT_TRUE(happens([this] { return !map_->map().empty(); }));
  for (const char* process : {"merge", "ingest"}) {
    stack_->kill(process);
    stack_->start(process);
  }
  EXPECT_TRUE(map_becomes(robot_->map()));
}

TEST_F(StackSystemTest, processes_may_start_last) {
  add_robot(network().add("robot1"), noisy_map(24, 3));
  ASSERT_TRUE(happens([this] { return robot_->sender().idle(); }));
  stack_->start("merge");
  stack_->start("ingest");
  ASSERT_TRUE(robot_is_known());
  align();
  listen_to_map(*person_);
  EXPECT_TRUE(map_becomes(robot_->map()));
}

TEST_F(StackSystemTest, the_map_outlives_its_agents_and_every_process) {
  stack_->start_all();
  listen_to_map(*person_);
  add_robot(network().add("robot1"), noisy_map(24, 4));
  ASSERT_TRUE(robot_is_known());
  align();
  ASSERT_TRUE(map_becomes(robot_->map()));
  const BrickMap before = map_->map();
  map_.reset();
  robot_.reset();

  stack_->interrupt_all();
  stack_->start_all();
  listen_to_map(network().add("headset"));
  EXPECT_TRUE(map_becomes(before));
}

TEST_F(StackSystemTest, a_lease_that_is_held_for_some_time_is_freed_at_its_end) {
  stack_->start_all();
  EXPECT_EQ(stack_->start_concord(*person_, {"lease", "hold", "mine", "--box", "0 0 0 1 1 1", "--for", "1"}).wait(), 0);
  EXPECT_EQ(stack_->concord(*person_, "leases").find("mine"), std::string::npos);
}

TEST_F(StackSystemTest, who_frees_a_lease_ends_the_client_that_renews_it) {
  stack_->start_all();
  const std::string where = " --box \"0 0 0 1 1 1\" --author ";
  Process hold = stack_->start_concord(
      *person_, {"lease", "hold", "mine", "--box", "0 0 0 1 1 1", "--for", "60", "--author", "ann"});
  const auto held = [this] { return stack_->concord(*person_, "leases").find("mine") != std::string::npos; };
  ASSERT_TRUE(happens(held));
  EXPECT_THROW(stack_->concord(*person_, "edit add" + where + "tom"), std::runtime_error) << "ann's";
  EXPECT_THROW(stack_->concord(*person_, "lease free mine --author tom"), std::runtime_error) << "ann's";
  EXPECT_TRUE(hold.runs());
  stack_->concord(*person_, "lease free mine --author ann");
  EXPECT_EQ(hold.wait(), 3);
  EXPECT_FALSE(held());
  stack_->concord(*person_, "edit add" + where + "tom");
}

TEST_F(StackSystemTest, an_edit_is_in_the_map_and_survives_the_killing_of_merge) {
  stack_->start_all();
  listen_to_map(*person_);
  add_robot(network().add("robot1"), noisy_map(8, 5));
  ASSERT_TRUE(robot_is_known());
  align();
  ASSERT_TRUE(map_becomes(robot_->map()));

  stack_->concord(*person_, "edit add --box \"0.01 0.01 2.01 0.99 0.04 2.99\"");
  stack_->kill("merge");  // it has answered, so it must remember
  stack_->start("merge");
  ASSERT_TRUE(happens([this] { return map_->synced() && is_occupied(map_->map().at({10, 0, 50})); }));
  EXPECT_GE(map_->map().occupied_count(), robot_->map().occupied_count() + 20 * 20);
}

}  // namespace
}  // namespace concord::test
