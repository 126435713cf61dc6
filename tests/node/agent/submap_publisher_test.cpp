#include "agent/submap_publisher.hpp"

#include <gtest/gtest.h>
#include <octomap/octomap.h>

#include <optional>

#include "agent/submap_from_octree.hpp"
#include "bus/lockstep_bus.hpp"
#include "bus/messages.hpp"

namespace concord {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;

/// A wall of bricks, no two alike.
BrickMap some_map(int size) {
  BrickMap map;
  for (int x = 0; x < size; ++x) {
    for (int y = 0; y < size; ++y) {
      DenseBrick dense;
      dense.fill(kUnknown);
      for (int v = 0; v < 90; ++v) {
        dense[(v * 37 + x * 5 + y * 11) % kBrickVoxels] = static_cast<LogOdds>((v * 131 + x * 7 + y) % 3000 - 1200);
      }
      map.set({x, y, 0}, Brick::from_dense(dense));
    }
  }
  return map;
}

Brick full(LogOdds value) {
  VoxelMask all;
  all.fill(~std::uint64_t{0});
  return Brick::uniform(all, value);
}

/// A robot on one side, what the stack would hold of it on the other.
class Publishing : public testing::Test {
 protected:
  Publishing() {
    listen<BrickPacket>(bus_, counters_, "test", "in/robot1/bricks",
                        [this](const std::string&, const BrickPacket& packet) {
                          bricks_sent_ += packet.count;
                          receiver_.on_packet(packet);
                        });
    listen<BrickDigest>(bus_, counters_, "test", "in/robot1/digest",
                        [this](const std::string&, const BrickDigest& digest) { receiver_.on_digest(digest); });
    listen<AgentPose>(bus_, counters_, "test", "in/robot1/pose",
                      [this](const std::string&, const AgentPose& pose) { pose_ = pose; });
  }

  void run_seconds(double seconds) {
    bus_.advance_to(bus_.now() + static_cast<std::int64_t>(seconds * 1e6));
    bus_.deliver();
  }

  void frame_is_over(const std::string& agent, const std::string& frame_id) {
    bus_.publish("out/frame_over/" + agent, encode(FrameOver{bus_.now(), frame_id}));
    bus_.deliver();
  }

  LockstepBus bus_{kStart};
  Counters counters_;
  BrickMap received_;
  int frames_ = 0;
  std::int64_t bricks_sent_ = 0;
  std::optional<AgentPose> pose_;
  int resets_ = 0;
  BrickReceiver receiver_{
      bus_,
      counters_,
      {.stream = "in/robot1"},
      {.on_frame =
           [this](const std::string&) {
             received_.clear();
             ++frames_;
           },
       .on_brick = [this](BrickIndex index, Brick brick) { received_.set(index, std::move(brick)); },
       .on_end = [] {}}};
  SubmapPublisher publisher_{bus_, counters_, {.agent = "robot1", .boot_id = kStart}, [this] { ++resets_; }};
};

TEST_F(Publishing, TheStackEndsWithTheSubmap) {
  const BrickMap map = some_map(20);
  publisher_.begin_frame("f1");
  EXPECT_EQ(publisher_.publish(map), 400U);
  run_seconds(3);
  EXPECT_TRUE(publisher_.idle());
  EXPECT_TRUE(receiver_.synced());
  EXPECT_TRUE(received_ == map);
  EXPECT_EQ(receiver_.frame_id(), "f1");
  EXPECT_EQ(frames_, 1);
}

TEST_F(Publishing, SendsOnlyWhatChanged) {
  BrickMap map = some_map(30);
  publisher_.begin_frame("f1");
  publisher_.publish(map);
  run_seconds(3);
  const std::int64_t whole = publisher_.bytes_sent();
  EXPECT_EQ(bricks_sent_, 900);

  EXPECT_EQ(publisher_.publish(map), 0U);
  map.set({3, 3, 0}, full(kOccupied));
  map.set({4, 3, 0}, Brick());
  map.set({4, 3, 7}, full(kFree));
  EXPECT_EQ(publisher_.publish(map), 3U);
  run_seconds(0.2);
  EXPECT_EQ(bricks_sent_, 903);
  EXPECT_LT(publisher_.bytes_sent() - whole, whole / 100);
  run_seconds(2);
  EXPECT_TRUE(received_ == map);
}

TEST_F(Publishing, BricksOneByOne) {
  publisher_.begin_frame("f1");
  EXPECT_TRUE(publisher_.publish_brick({1, 2, 3}, full(kOccupied)));
  EXPECT_FALSE(publisher_.publish_brick({1, 2, 3}, full(kOccupied)));
  EXPECT_FALSE(publisher_.publish_brick({9, 9, 9}, Brick()));
  run_seconds(2);
  EXPECT_EQ(received_.known_count(), 512U);
  EXPECT_TRUE(publisher_.publish_brick({1, 2, 3}, Brick()));
  run_seconds(2);
  EXPECT_TRUE(received_.empty());
}

TEST_F(Publishing, ANewFrameVoidsTheOldOne) {
  publisher_.begin_frame("f1");
  publisher_.publish(some_map(5));
  run_seconds(2);
  publisher_.begin_frame("f2");
  publisher_.publish(some_map(3));
  run_seconds(2);
  EXPECT_EQ(frames_, 2);
  EXPECT_EQ(receiver_.frame_id(), "f2");
  EXPECT_TRUE(received_ == some_map(3));
}

TEST_F(Publishing, PosesCarryTheFrame) {
  publisher_.begin_frame("f1");
  Transform T = Transform::Identity();
  T.translation() = Eigen::Vector3d(1, 2, 3);
  publisher_.publish_pose(T, kStart + 5);
  bus_.deliver();
  ASSERT_TRUE(pose_);
  EXPECT_EQ(pose_->frame_id, "f1");
  EXPECT_EQ(pose_->utime, kStart + 5);
  EXPECT_TRUE(pose_->T_agent_base.isApprox(T));
}

TEST_F(Publishing, TellsTheRobotOnceThatItsFrameIsOver) {
  frame_is_over("robot1", "f1");
  EXPECT_EQ(resets_, 0) << "it has begun none";
  publisher_.begin_frame("f1");
  frame_is_over("robot2", "f1");
  frame_is_over("robot1", "f0");
  EXPECT_EQ(resets_, 0);
  frame_is_over("robot1", "f1");
  frame_is_over("robot1", "f1");
  EXPECT_EQ(resets_, 1);
  publisher_.begin_frame("f2");
  frame_is_over("robot1", "f1");
  EXPECT_EQ(resets_, 1) << "late";
  frame_is_over("robot1", "f2");
  EXPECT_EQ(resets_, 2);
  bus_.publish("out/frame_over/robot1", Bytes{1, 2, 3});
  bus_.deliver();
  EXPECT_EQ(resets_, 2);
  EXPECT_EQ(counters_.get("refused.out/frame_over/robot1.MALFORMED"), 1);
}

TEST_F(Publishing, APersonsWishAloneResetsNothing) {
  publisher_.begin_frame("f1");
  bus_.publish("in/agent_request", encode(AgentRequest{"r1", "robot1", AgentRequest::Op::kReset}, bus_.now()));
  bus_.deliver();
  EXPECT_EQ(resets_, 0) << "ingest may refuse it";
}

TEST(ResetListener, HearsNothingAfterItsEnd) {
  LockstepBus bus(kStart);
  Counters counters;
  int resets = 0;
  {
    ResetListener listener(bus, counters, "robot1", [&] { ++resets; });
    listener.begin_frame("f");
  }
  bus.publish("out/frame_over/robot1", encode(FrameOver{kStart, "f"}));
  bus.deliver();
  EXPECT_EQ(resets, 0);
}

TEST(SubmapFromOctree, HoldsWhatTheTreeHolds) {
  octomap::OcTree tree(0.05);
  for (int i = 0; i < 500; ++i) {
    const octomap::point3d p(0.025F + 0.05F * static_cast<float>(i % 16), 0.025F + 0.05F * static_cast<float>(i / 16),
                             -0.475F);
    tree.updateNode(p, i % 3 != 0);
  }
  const Result<BrickMap> map = submap_from_octree(tree, 0.05);
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->known_count(), 500U);
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const auto key = leaf.getKey();
    const LogOdds value = map->at({key[0] - 32768, key[1] - 32768, key[2] - 32768});
    ASSERT_TRUE(is_known(value));
    EXPECT_EQ(is_occupied(value), tree.isNodeOccupied(*leaf));
    EXPECT_NEAR(to_double(value), leaf->getLogOdds(), 1.0 / 2048);
  }
}

TEST(SubmapFromOctree, OfAnEmptyTree) {
  const Result<BrickMap> map = submap_from_octree(octomap::OcTree(0.05), 0.05);
  ASSERT_TRUE(map);
  EXPECT_TRUE(map->empty());
}

}  // namespace
}  // namespace concord
