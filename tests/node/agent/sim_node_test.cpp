#include "agent/sim/sim_node.hpp"

#include <gtest/gtest.h>

#include "bus/lockstep_bus.hpp"
#include "bus/messages.hpp"
#include "core/scan.hpp"

namespace concord {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;

/// A simulated agent, and what it was heard to say.
class Simulated : public testing::Test {
 protected:
  Simulated() {
    listen<BrickPacket>(bus_, counters_, "test", "in/a/bricks",
                        [this](const std::string&, const BrickPacket& packet) { receiver_.on_packet(packet); });
    listen<BrickDigest>(bus_, counters_, "test", "in/a/digest",
                        [this](const std::string&, const BrickDigest& digest) { receiver_.on_digest(digest); });
    listen<CloudMessage>(bus_, counters_, "test", "in/a/cloud",
                         [this](const std::string&, const CloudMessage& cloud) { clouds_.push_back(cloud); });
    listen<AgentPose>(bus_, counters_, "test", "in/a/pose",
                      [this](const std::string&, const AgentPose& pose) { poses_.push_back(pose); });
  }

  void start(AgentKind kind) {
    const NodeContext context{bus_, counters_, site_, "sim-a", kStart};
    node_.emplace(context, SimNode::Config{.agent = "a", .kind = kind, .seed = 4, .speed = 2});
  }

  void run_seconds(double seconds) {
    bus_.advance_to(bus_.now() + static_cast<std::int64_t>(seconds * 1e6));
    bus_.deliver();
  }

  void reset() {
    bus_.publish("out/frame_over/a", encode(FrameOver{bus_.now(), receiver_.frame_id()}));
    bus_.deliver();
  }

  LockstepBus bus_{kStart};
  Counters counters_;
  Site site_ = [] {
    Site site;
    site.resolution = 0.1;
    site.stream.bytes_per_second = 1e9;
    return site;
  }();
  BrickMap received_;
  std::vector<CloudMessage> clouds_;
  std::vector<AgentPose> poses_;
  BrickReceiver receiver_{
      bus_,
      counters_,
      {.stream = "in/a", .resolution = 0.1},
      {.on_frame = [this](const std::string&) { received_.clear(); },
       .on_brick = [this](BrickIndex index, Brick brick) { received_.set(index, std::move(brick)); },
       .on_end = [] {}}};
  std::optional<SimNode> node_;
};

/// What the agent would have mapped by itself until `time` on its way.
BrickMap mapped(AgentKind kind, std::uint64_t seed, double time) {
  const RayCaster world(make_warehouse(4));
  SimulatedAgent agent(world, kind, seed);
  BrickMap map;
  while (agent.next_time() <= time) {
    const std::optional<Moment> moment = agent.next();
    const Result<CheckedScan> scan =
        checked({moment->T_agent_sensor, agent.sensor().trusted_range, moment->points}, 0.1);
    EXPECT_TRUE(scan && integrate(map, 0.1, scan->scan));
  }
  return map;
}

TEST_F(Simulated, ALidarRobotSendsItsSubmap) {
  start(AgentKind::kLidar);
  run_seconds(2.1);  // 4.2 s of its way
  EXPECT_TRUE(receiver_.synced());
  EXPECT_TRUE(received_ == mapped(AgentKind::kLidar, 4000, 4.0));
  EXPECT_EQ(poses_.size(), 9U);
  EXPECT_GT(poses_.back().T_agent_base.translation().x(), 3);
  EXPECT_TRUE(clouds_.empty());
  EXPECT_EQ(counters_.get("scans"), 9);
  EXPECT_GT(counters_.get("progress_percent"), 0);
  EXPECT_GT(counters_.get("bytes_sent"), 10000);
}

TEST_F(Simulated, ACameraRobotSendsClouds) {
  start(AgentKind::kCamera);
  run_seconds(2.05);
  EXPECT_FALSE(receiver_.heard());
  ASSERT_EQ(clouds_.size(), 21U);
  for (std::size_t i = 0; i < clouds_.size(); ++i) EXPECT_EQ(clouds_[i].sequence, static_cast<std::int64_t>(i));
  EXPECT_TRUE(clouds_[5].T_agent_sensor);
  EXPECT_EQ(clouds_[5].max_range, 5);
  EXPECT_LT(encode(clouds_[5]).size(), 65'000U) << "must fit one datagram";
  EXPECT_EQ(clouds_[5].frame_id, poses_[5].frame_id);
}

TEST_F(Simulated, AResetBringsItBackToItsStartInANewFrame) {
  start(AgentKind::kHeadset);
  run_seconds(2.13);
  const std::string before = receiver_.frame_id();
  const std::size_t poses = poses_.size();
  EXPECT_FALSE(received_.empty());
  reset();
  run_seconds(1.1);  // changes were sent 0.87 s after the reset, 1.74 s into its way
  EXPECT_NE(receiver_.frame_id(), before);
  EXPECT_TRUE(receiver_.synced());
  EXPECT_TRUE(received_ == mapped(AgentKind::kHeadset, 4201, 1.7));
  ASSERT_GT(poses_.size(), poses);
  EXPECT_NE(poses_[poses].frame_id, before);
  EXPECT_LT(poses_[poses].T_agent_base.translation().norm(), 0.05);
}

TEST_F(Simulated, StaysAtTheEndOfItsWay) {
  start(AgentKind::kHeadset);
  run_seconds(60);  // its way takes less than 60 s, at twice the speed half of that
  EXPECT_EQ(counters_.get("progress_percent"), 100);
  const std::int64_t scans = counters_.get("scans");
  EXPECT_GT(scans, 200);
  run_seconds(5);
  EXPECT_EQ(counters_.get("scans"), scans);
  EXPECT_TRUE(receiver_.synced());
  EXPECT_GT(received_.occupied_count(), 10000U);
}

}  // namespace
}  // namespace concord
