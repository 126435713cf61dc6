#include <random>

#include "station.hpp"

namespace concord::testing {
namespace {

using IngestNodeTest = IngestStation;

TEST_F(IngestNodeTest, a_brick_stream_passes_through_whole) {
  Robot robot(*start_, "robot1", "boot-1", some_map(500), site_.resolution);
  start_->run(1);
  EXPECT_EQ(start_->follower["robot1"].map, robot.map());
  EXPECT_EQ(start_->follower["robot1"].frame_id, "boot-1");
  robot.set({0, 0, 0}, Brick{});
  robot.set({99, 0, 0}, Brick::uniform({5}, kOccupied));
  start_->run(0.1);
  EXPECT_EQ(start_->follower["robot1"].map, robot.map());
}

TEST_F(IngestNodeTest, a_robot_whose_slam_began_anew_voids_its_old_frame) {
  Robot robot(*start_, "robot1", "boot-1", some_map(50), site_.resolution);
  start_->run(1);
  robot.begin("boot-2");
  start_->run(1);
  EXPECT_EQ(start_->follower["robot1"].frame_id, "boot-2");
  EXPECT_EQ(start_->follower["robot1"].frames, 2);
  EXPECT_EQ(start_->follower["robot1"].map, robot.map());
}

TEST_F(IngestNodeTest, octomaps_and_clouds_are_streamed_on) {
  say_octomap("robot1", "f", some_map(30));
  EXPECT_EQ(start_->follower["robot1"].map, some_map(30));
  say_octomap("robot1", "f", some_map(20));
  EXPECT_EQ(start_->follower["robot1"].map, some_map(20));

  const CloudMessage cloud{1, 7, 3, "g", std::nullopt, 0, {{0.05F, 0.05F, 0.05F}, {1, NAN, 1}}};
  start_->say("in/robot2/cloud", cloud);
  start_->say("in/robot2/cloud", cloud);
  start_->run(2);
  EXPECT_EQ(start_->follower["robot2"].map.known_count(), 1U);
  EXPECT_EQ(start_->counters.get("gaps.robot2"), 3);
  EXPECT_EQ(start_->counters.get("duplicates.robot2"), 1);
  EXPECT_EQ(start_->counters.get("points_skipped"), 1);
  EXPECT_EQ(start_->counters.get("agents"), 2);
  EXPECT_EQ(start_->counters.get("known.robot2"), 1);
}

TEST_F(IngestNodeTest, all_is_back_after_a_restart_when_every_sender_has_gone) {
  {
    const Robot robot(*start_, "robot1", "boot-1", some_map(300, 1), site_.resolution);
    start_->run(2);
  }
  say_octomap("robot2", "f", some_map(200, 2));
  start_->say("in/robot3/cloud", CloudMessage{1, 7, 0, "g", std::nullopt, 0, {{0.05F, 0.05F, 0.05F}}});
  restart();
  start_->run(2);
  EXPECT_EQ(start_->follower["robot1"].map, some_map(300, 1));
  EXPECT_EQ(start_->follower["robot1"].frame_id, "boot-1");
  EXPECT_EQ(start_->follower["robot2"].map, some_map(200, 2));
  EXPECT_EQ(start_->follower["robot3"].map.known_count(), 1U);
  start_->say("in/robot3/cloud", CloudMessage{1, 7, 0, "g", std::nullopt, 0, {{9.05F, 0.05F, 0.05F}}});
  EXPECT_EQ(start_->counters.get("duplicates.robot3"), 1) << "clouds go on being counted";
}

TEST_F(IngestNodeTest, the_disk_is_at_most_five_seconds_behind) {
  say_octomap("robot1", "f", some_map(100));
  start_->run(5);
  // What a kill at this moment would leave.
  Site other = site_;
  other.state = site_.state / "copy";
  std::filesystem::create_directories(other.state);
  for (const char* file : {"ingest.db", "ingest.db-wal"}) {
    std::filesystem::copy_file(site_.state / file, other.state / file);
  }
  Start survivor(other, begin_ + 1000 * kSecond);
  survivor.run(1);
  EXPECT_EQ(survivor.follower["robot1"].map, some_map(100));
}

TEST_F(IngestNodeTest, a_robot_that_still_has_what_is_on_disk_sends_nothing_again) {
  const BrickMap map = some_map(300);
  {
    const Robot robot(*start_, "robot1", "boot-1", map, site_.resolution);
    start_->run(2);
  }
  restart();
  const auto bricks = static_cast<std::int64_t>(map.brick_count());
  for (int i = 0; i < 3; ++i) {
    start_->say("in/robot1/digest",
                BrickDigest{start_->bus.now(), begin_, "boot-1", site_.resolution, bricks, bricks, digest(map)});
    start_->run(1);
  }
  EXPECT_EQ(start_->requests, 0);
  EXPECT_EQ(start_->follower["robot1"].map, map);
}

TEST_F(IngestNodeTest, what_changed_while_ingest_was_down_is_asked_for) {
  {
    const Robot robot(*start_, "robot1", "boot-1", some_map(300), site_.resolution);
    start_->run(2);
  }
  restart();
  BrickMap changed = some_map(290);
  changed.set({50, 50, 50}, Brick::uniform({1}, kOccupied));
  const Robot robot(*start_, "robot1", "boot-1", changed, site_.resolution);
  start_->run(3);
  EXPECT_EQ(start_->follower["robot1"].map, changed);
}

TEST_F(IngestNodeTest, a_live_stream_is_not_overrun_by_an_octomap_but_a_silent_one_is) {
  auto robot = std::make_optional<Robot>(*start_, "robot1", "boot-1", some_map(20), site_.resolution);
  start_->run(2);
  say_octomap("robot1", "other", some_map(5));
  EXPECT_EQ(start_->follower["robot1"].frame_id, "boot-1");
  EXPECT_EQ(start_->counters.get("refused.in/robot1/octomap.BAD_REQUEST"), 1);
  robot.reset();
  start_->run(4);
  say_octomap("robot1", "other", some_map(5));
  EXPECT_EQ(start_->follower["robot1"].frame_id, "other");
  EXPECT_EQ(start_->follower["robot1"].map, some_map(5));
  // And back: the stream has the last word.
  robot.emplace(*start_, "robot1", "boot-1", some_map(20), site_.resolution);
  start_->run(2);
  EXPECT_EQ(start_->follower["robot1"].frame_id, "boot-1");
  EXPECT_EQ(start_->follower["robot1"].map, some_map(20));
}

TEST_F(IngestNodeTest, what_a_full_layer_refused_is_asked_for_when_there_is_room) {
  VoxelMask all;
  all.fill(~std::uint64_t{0});
  site_.ingest.max_known_voxels = 10 * kBrickVoxels;
  restart();
  Robot robot(*start_, "robot1", "boot-1", BrickMap(), site_.resolution);
  for (int i = 0; i < 12; ++i) robot.set({i, 0, 0}, Brick::uniform(all, kFree));
  start_->run(5);
  EXPECT_EQ(start_->follower["robot1"].map.brick_count(), 10U);
  EXPECT_EQ(start_->counters.get("lacking.robot1"), 1);
  const int requests = start_->requests;
  start_->run(5);
  EXPECT_EQ(start_->requests, requests) << "there is no room to ask for";
  for (int i = 0; i < 5; ++i) robot.set({i, 0, 0}, Brick{});
  start_->run(5);
  EXPECT_EQ(start_->follower["robot1"].map, robot.map());
  EXPECT_EQ(start_->counters.get("lacking.robot1"), 0);
}

TEST_F(IngestNodeTest, a_camera_robot_that_started_again_goes_on_in_its_frame) {
  CloudMessage cloud{1, 7, 5, "g", std::nullopt, 0, {{0.05F, 0.05F, 0.05F}}};
  start_->say("in/robot1/cloud", cloud);
  cloud.boot_id = 8;
  cloud.sequence = 0;
  cloud.points[0].x() = 1.05F;
  start_->say("in/robot1/cloud", cloud);
  start_->run(2);
  EXPECT_EQ(start_->follower["robot1"].map.known_count(), 2U);
}

TEST_F(IngestNodeTest, agents_beyond_the_limit_are_refused_by_name) {
  site_.ingest.max_agents = 2;
  restart();
  for (const char* id : {"a", "b", "c"}) say_octomap(id, "f", some_map(3));
  const Robot robot(*start_, "d", "f", some_map(3), site_.resolution);
  start_->run(2);
  EXPECT_EQ(start_->counters.get("agents"), 2);
  EXPECT_EQ(start_->counters.get("refused.in/c/octomap.TOO_LARGE"), 1);
  EXPECT_GT(start_->counters.get("refused.in/d/digest.TOO_LARGE"), 0);
}

TEST_F(IngestNodeTest, strangers_without_content_do_not_shut_out_a_robot_of_the_site) {
  site_.agents["robot1"];
  restart();
  for (int i = 0; i < 2500; ++i) {
    const std::string id = std::to_string(i);
    start_->bus.publish("in/" + id + "/digest",
                        encode(BrickDigest{start_->bus.now(), 7, "f", 2 * site_.resolution, 0, 0, 0}));
  }
  const Robot stranger(*start_, "stranger", "f", some_map(3), site_.resolution);
  const Robot robot(*start_, "robot1", "f", some_map(3), site_.resolution);
  start_->run(2);
  EXPECT_EQ(start_->follower["robot1"].map, some_map(3));
  EXPECT_TRUE(start_->follower["stranger"].map.empty());
  start_->run(4);
  EXPECT_EQ(start_->follower["stranger"].map, some_map(3)) << "those who are silent are forgotten";
}

TEST_F(IngestNodeTest, no_bytes_harm_it) {
  say_octomap("robot1", "f", some_map(20));
  std::mt19937 random(7);
  const Bytes good = encode(OctomapMessage{1, "f", site_.resolution, false, {1, 2, 3, 4, 5, 6, 7, 8, 9}});
  for (const char* channel : {"in/robot1/bricks", "in/robot1/digest", "in/robot1/octomap", "in/robot1/cloud",
                              "in/agent_request", "in/map_request", "in/downsample", "in/../octomap"}) {
    for (int i = 0; i < 200; ++i) {
      Bytes bytes = i % 2 == 0 ? good : Bytes(random() % 100);
      for (int k = 0; k < 3 && !bytes.empty(); ++k)
        bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
      start_->bus.publish(channel, bytes);
    }
  }
  start_->run(2);
  EXPECT_EQ(start_->follower["robot1"].map, some_map(20));
  EXPECT_EQ(start_->counters.get("agents"), 1);
  EXPECT_EQ(start_->counters.get("exceptions"), 0);
}

TEST_F(IngestNodeTest, damaged_layers_are_counted_and_the_process_serves) {
  say_octomap("robot1", "f", some_map(20));
  start_.reset();
  ASSERT_TRUE(
      Database(site_.state / "ingest.db", std::array{""}).execute("UPDATE brick SET voxels = x'ff' WHERE y = 0"));
  restart();
  EXPECT_EQ(start_->counters.get("refused.disk.robot1.MALFORMED"), 1);
  say_octomap("robot1", "f", some_map(20));
  EXPECT_EQ(start_->follower["robot1"].map, some_map(20));
}

}  // namespace
}  // namespace concord::testing
