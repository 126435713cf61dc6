#include "ingest/ingest.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>

#include "core/map_archive.hpp"
#include "layers.hpp"

namespace concord {
namespace {

using testing::box;
using testing::kResolution;
using testing::Mirror;
using testing::numbered;
using testing::octomap_of;

constexpr Ingest::Config kConfig{.resolution = kResolution, .max_agents = 3, .max_known_voxels = 100'000};

class IngestTest : public ::testing::Test {
 protected:
  Result<Change> octomap(const std::string& id, const std::string& frame, const BrickMap& map,
                         OctomapFormat format = OctomapFormat::kFull) {
    return ingest_.take_octomap(id, frame, octomap_of(map, format), format, kResolution);
  }

  Result<CloudChange> cloud(const std::string& frame, CloudNumber number, const Scan& scan, std::int64_t now = 1) {
    return ingest_.take_cloud("robot1", frame, number, scan, now);
  }

  Ingest ingest_{kConfig};
  const BrickMap wall_ = box({0, 0, 0}, {20, 0, 9}, kOccupied);
  const BrickMap floor_ = box({-9, -9, 0}, {20, 9, 0}, kFree);
};

template <class T>
Code code_of(const Result<T>& result) {
  EXPECT_FALSE(result);
  return result.error().code;
}

TEST_F(IngestTest, the_first_octomap_makes_the_agent) {
  const auto change = octomap("robot1", "start-1", wall_, OctomapFormat::kBinary);
  ASSERT_TRUE(change) << change.error().message;
  EXPECT_TRUE(change->new_frame);
  EXPECT_EQ(change->bricks, wall_.sorted_bricks());
  const Agent* agent = ingest_.find("robot1");
  ASSERT_NE(agent, nullptr);
  EXPECT_EQ(agent->layer, wall_);
  EXPECT_EQ(agent->frame_id, "start-1");
  EXPECT_EQ(agent->known(), 21 * 10);
}

TEST_F(IngestTest, an_octomap_sent_again_changes_nothing) {
  ASSERT_TRUE(octomap("robot1", "f", wall_));
  const auto again = octomap("robot1", "f", wall_);
  ASSERT_TRUE(again);
  EXPECT_FALSE(again->new_frame);
  EXPECT_TRUE(again->bricks.empty());
}

TEST_F(IngestTest, an_octomap_replaces_all_and_touches_only_what_differs) {
  ASSERT_TRUE(octomap("robot1", "f", box({0, 0, 0}, {23, 7, 7}, kFree)));
  BrickMap next = box({0, 0, 0}, {7, 7, 7}, kFree);     // stays
  next.set({1, 0, 0}, Brick::uniform({7}, kOccupied));  // differs
  next.set({5, 0, 0}, Brick::uniform({1}, kFree));      // new
  const auto change = octomap("robot1", "f", next);     // {2, 0, 0} vanished
  ASSERT_TRUE(change);
  EXPECT_EQ(change->bricks, (std::vector<BrickIndex>{{1, 0, 0}, {2, 0, 0}, {5, 0, 0}}));
  EXPECT_EQ(ingest_.find("robot1")->layer, next);
  EXPECT_EQ(ingest_.find("robot1")->known(), static_cast<std::int64_t>(next.known_count()));
}

TEST_F(IngestTest, another_resolution_is_brought_to_the_sites) {
  const auto change = ingest_.take_octomap("robot1", "f", octomap_of(box({0, 0, 0}, {3, 3, 3}, kOccupied)),
                                           OctomapFormat::kFull, 2 * kResolution);
  ASSERT_TRUE(change) << change.error().message;
  EXPECT_EQ(ingest_.find("robot1")->layer, box({0, 0, 0}, {7, 7, 7}, kOccupied));
}

TEST_F(IngestTest, bad_bytes_make_no_agent_and_change_none) {
  const Bytes junk = {1, 2, 3};
  EXPECT_EQ(code_of(ingest_.take_octomap("robot1", "f", junk, OctomapFormat::kFull, kResolution)), Code::kMalformed);
  EXPECT_TRUE(ingest_.agents().empty());
  ASSERT_TRUE(octomap("robot1", "f", wall_));
  EXPECT_FALSE(ingest_.take_octomap("robot1", "g", junk, OctomapFormat::kFull, kResolution));
  EXPECT_EQ(ingest_.find("robot1")->frame_id, "f");
  EXPECT_EQ(ingest_.find("robot1")->layer, wall_);
}

TEST_F(IngestTest, ids_and_frames_are_names) {
  EXPECT_EQ(code_of(octomap("../etc", "f", wall_)), Code::kBadName);
  EXPECT_EQ(code_of(octomap("", "f", wall_)), Code::kBadName);
  EXPECT_EQ(code_of(octomap("robot1", "", wall_)), Code::kBadFrame);
  EXPECT_EQ(code_of(octomap("robot1", "a b", wall_)), Code::kBadFrame);
}

TEST_F(IngestTest, agents_are_limited_in_number_and_size) {
  for (const char* id : {"a", "b", "c"}) ASSERT_TRUE(octomap(id, "f", wall_));
  EXPECT_EQ(code_of(octomap("d", "f", wall_)), Code::kTooLarge);
  ingest_.remove("b");
  EXPECT_TRUE(octomap("d", "f", wall_));
  EXPECT_EQ(code_of(octomap("a", "f", box({0, 0, 0}, {47, 47, 47}, kFree))), Code::kTooLarge);
  EXPECT_EQ(ingest_.find("a")->layer, wall_);
}

TEST_F(IngestTest, a_new_frame_voids_the_old_one) {
  ASSERT_TRUE(octomap("robot1", "f", wall_));
  const auto change = octomap("robot1", "g", floor_);
  ASSERT_TRUE(change);
  EXPECT_TRUE(change->new_frame);
  EXPECT_EQ(change->bricks, floor_.sorted_bricks());
}

TEST_F(IngestTest, a_stream_sets_single_bricks) {
  ASSERT_TRUE(ingest_.begin_stream("robot1", "f"));
  const Brick brick = Brick::uniform({3}, kOccupied);
  EXPECT_TRUE(ingest_.set_brick("robot1", {1, 2, 3}, brick).value());
  EXPECT_FALSE(ingest_.set_brick("robot1", {1, 2, 3}, brick).value());
  EXPECT_EQ(ingest_.find("robot1")->known(), 2);
  EXPECT_TRUE(ingest_.set_brick("robot1", {1, 2, 3}, Brick{}).value());
  EXPECT_EQ(ingest_.find("robot1")->known(), 0);
  EXPECT_TRUE(ingest_.find("robot1")->layer.empty());
}

TEST_F(IngestTest, a_full_layer_takes_no_more_voxels_but_gives_some_up) {
  VoxelMask all;
  all.fill(~std::uint64_t{0});
  ASSERT_TRUE(ingest_.begin_stream("robot1", "f"));
  int bricks = 0;
  while (ingest_.set_brick("robot1", {bricks, 0, 0}, Brick::uniform(all, kFree))) ++bricks;
  EXPECT_EQ(bricks, kConfig.max_known_voxels / kBrickVoxels);
  EXPECT_EQ(code_of(ingest_.set_brick("robot1", {-1, 0, 0}, Brick::uniform(all, kFree))), Code::kTooLarge);
  EXPECT_TRUE(ingest_.set_brick("robot1", {0, 0, 0}, Brick{}).value());
  EXPECT_TRUE(ingest_.set_brick("robot1", {-1, 0, 0}, Brick::uniform(all, kFree)).value());
}

TEST_F(IngestTest, within_a_frame_a_stream_has_the_last_word) {
  ASSERT_TRUE(octomap("robot1", "f", wall_));
  const auto change = ingest_.begin_stream("robot1", "f");
  ASSERT_TRUE(change);
  EXPECT_FALSE(change->new_frame);
  EXPECT_EQ(change->bricks, wall_.sorted_bricks());
  EXPECT_TRUE(ingest_.find("robot1")->layer.empty());
  EXPECT_EQ(code_of(octomap("robot1", "f", wall_)), Code::kBadRequest);
  EXPECT_TRUE(octomap("robot1", "g", wall_)) << "the newest frame wins";
}

TEST_F(IngestTest, clouds_add_up) {
  const Scan scan{std::nullopt, 0, {{0.05F, 0.05F, 0.05F}, {1.05F, 0.05F, 0.05F}}};
  const auto first = cloud("f", {1, 0}, scan);
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_TRUE(first->change.new_frame);
  EXPECT_EQ(first->change.bricks, (std::vector<BrickIndex>{{0, 0, 0}, {1, 0, 0}}));
  const auto second = cloud("f", {1, 1}, scan);
  ASSERT_TRUE(second);
  EXPECT_FALSE(second->change.new_frame);
  EXPECT_EQ(second->lost, 0);
  EXPECT_EQ(ingest_.find("robot1")->layer.at({10, 0, 0}), 2 * kHit);
  EXPECT_EQ(ingest_.find("robot1")->known(), 2);
}

TEST_F(IngestTest, rays_from_a_known_sensor_free_space) {
  Transform T_agent_sensor = Transform::Identity();
  T_agent_sensor.translation() = Eigen::Vector3d(0.05, 0.05, 0.05);
  ASSERT_TRUE(cloud("f", {1, 0}, {T_agent_sensor, 0, {{1.05F, 0.05F, 0.05F}}}));
  const BrickMap& layer = ingest_.find("robot1")->layer;
  EXPECT_EQ(layer.at({5, 0, 0}), kMiss);
  EXPECT_EQ(layer.at({10, 0, 0}), kHit);
}

TEST_F(IngestTest, clouds_that_are_lost_or_come_twice_are_known) {
  const Scan scan{std::nullopt, 0, {{0.05F, 0.05F, 0.05F}}};
  EXPECT_EQ(cloud("f", {1, 2}, scan).value().lost, 2);
  EXPECT_TRUE(cloud("f", {1, 2}, scan).value().duplicate);
  EXPECT_TRUE(cloud("f", {1, 0}, scan).value().duplicate);
  EXPECT_EQ(ingest_.find("robot1")->layer.at({0, 0, 0}), kHit) << "a duplicate adds nothing";
  EXPECT_EQ(cloud("f", {1, 5}, scan).value().lost, 2);
  EXPECT_EQ(cloud("g", {1, 0}, scan).value().lost, 0) << "a new frame counts anew";
  EXPECT_EQ(code_of(cloud("g", {1, -1}, scan)), Code::kBadRequest);
  EXPECT_EQ(code_of(cloud("g", {1, std::numeric_limits<std::int64_t>::max()}, scan)), Code::kBadRequest);
}

TEST_F(IngestTest, a_sender_that_started_again_counts_its_clouds_anew) {
  const Scan scan{std::nullopt, 0, {{0.05F, 0.05F, 0.05F}}};
  const std::int64_t second = 1'000'000;
  ASSERT_TRUE(cloud("f", {100, 7}, scan, 10 * second));
  const auto next = cloud("f", {200, 0}, scan, 11 * second);
  ASSERT_TRUE(next) << next.error().message;
  EXPECT_FALSE(next->duplicate);
  EXPECT_FALSE(next->change.new_frame);
  EXPECT_EQ(next->lost, 0);
  EXPECT_EQ(cloud("f", {200, 2}, scan, 11 * second).value().lost, 1);
  EXPECT_EQ(code_of(cloud("f", {100, 8}, scan, 12 * second)), Code::kStale) << "was long under way";
  EXPECT_EQ(ingest_.find("robot1")->layer.at({0, 0, 0}), 3 * kHit);
  EXPECT_TRUE(cloud("f", {100, 0}, scan, 15 * second)) << "its clock went back";
}

TEST_F(IngestTest, a_bad_cloud_changes_nothing) {
  const Scan bad{std::nullopt, -1.0, {{0.05F, 0.05F, 0.05F}}};
  EXPECT_FALSE(cloud("f", {1, 0}, bad));
  EXPECT_TRUE(ingest_.agents().empty());
  ASSERT_TRUE(octomap("robot1", "f", wall_));
  EXPECT_FALSE(cloud("g", {1, 0}, bad));
  EXPECT_EQ(ingest_.find("robot1")->frame_id, "f");
}

TEST_F(IngestTest, clouds_add_to_an_octomap_of_their_frame) {
  ASSERT_TRUE(octomap("robot1", "f", floor_));
  ASSERT_TRUE(cloud("f", {1, 0}, {std::nullopt, 0, {{0.05F, 0.05F, 3.05F}}}));
  EXPECT_EQ(ingest_.find("robot1")->known(), static_cast<std::int64_t>(floor_.known_count()) + 1);
}

TEST_F(IngestTest, after_a_reset_the_frame_is_over_for_good) {
  ASSERT_TRUE(octomap("robot1", "f", wall_));
  auto after = ingest_.after_reset("robot1");
  ASSERT_TRUE(after);
  EXPECT_EQ(ingest_.find("robot1")->layer, wall_) << "not before it is put";
  const Change change = ingest_.put("robot1", std::move(*after));
  EXPECT_FALSE(change.new_frame);
  EXPECT_EQ(change.bricks, wall_.sorted_bricks());
  EXPECT_EQ(code_of(octomap("robot1", "f", wall_)), Code::kBadFrame);
  EXPECT_EQ(code_of(ingest_.begin_stream("robot1", "f")), Code::kBadFrame);
  ASSERT_TRUE(octomap("robot1", "g", wall_));
  EXPECT_EQ(code_of(octomap("robot1", "f", wall_)), Code::kBadFrame) << "a late message of the old frame";
  EXPECT_EQ(ingest_.find("robot1")->frame_id, "g");
}

TEST_F(IngestTest, a_reset_is_done_once_and_memory_of_resets_is_bounded) {
  EXPECT_EQ(code_of(ingest_.after_reset("robot1")), Code::kNoAgent);
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(octomap("robot1", numbered("f", i), wall_));
    ingest_.put("robot1", ingest_.after_reset("robot1").value());
    ingest_.put("robot1", ingest_.after_reset("robot1").value());
  }
  const auto& dead = ingest_.find("robot1")->dead_frames;
  ASSERT_EQ(dead.size(), Ingest::kMaxDeadFrames);
  EXPECT_EQ(dead.front(), "f136");
  EXPECT_EQ(dead.back(), "f199");
}

TEST_F(IngestTest, a_removed_agent_is_forgotten_with_its_dead_frames) {
  ASSERT_TRUE(octomap("robot1", "f", wall_));
  ingest_.put("robot1", ingest_.after_reset("robot1").value());
  ingest_.remove("robot1");
  EXPECT_EQ(ingest_.find("robot1"), nullptr);
  EXPECT_TRUE(octomap("robot1", "f", wall_)) << "who still sends is a new agent";
}

TEST_F(IngestTest, a_file_becomes_an_agent) {
  const Bytes file = write_octomap_file(wall_, kResolution, OctomapFormat::kBinary).value();
  auto agent = ingest_.from_file("archive", "hall", file);
  ASSERT_TRUE(agent) << agent.error().message;
  EXPECT_EQ(ingest_.find("archive"), nullptr) << "not before it is put";
  EXPECT_EQ(agent->frame_id, "map-hall");
  const Change change = ingest_.put("archive", std::move(*agent));
  EXPECT_TRUE(change.new_frame);
  EXPECT_EQ(change.bricks, wall_.sorted_bricks());
  EXPECT_EQ(ingest_.find("archive")->layer, wall_);
  EXPECT_EQ(code_of(ingest_.from_file("archive", "hall", file)), Code::kExists);
  EXPECT_EQ(code_of(ingest_.admit("archive", "hall", Source::kFile)), Code::kExists) << "before a file is read";
  EXPECT_TRUE(ingest_.from_file("other", std::string(40, 'x'), file)) << "the longest name of a map";
}

TEST_F(IngestTest, the_layers_of_a_map_file_are_agents_when_none_of_them_is_there) {
  MapArchiveWriter writer(kResolution);
  ASSERT_TRUE(writer.add({"a", "robot", "f", 17, 3}, wall_));
  ASSERT_TRUE(writer.add({"b", "robot", "g", 17, 3}, BrickMap()));
  const Bytes file = std::move(writer).finish().value();
  const auto agents = ingest_.from_archive(file, "q1").value();
  ASSERT_EQ(agents.size(), 2U);
  EXPECT_EQ(agents[0].first, "a");
  EXPECT_EQ(agents[0].second.frame_id, "f");
  EXPECT_EQ(agents[0].second.source, Source::kFile);
  EXPECT_EQ(agents[0].second.incarnation, loaded_incarnation(file, "q1"));
  EXPECT_EQ(agents[0].second.layer, wall_);
  EXPECT_TRUE(agents[1].second.layer.empty());
  EXPECT_TRUE(ingest_.agents().empty());
  EXPECT_EQ(ingest_.loaded(loaded_incarnation(file, "q1")), std::nullopt);

  ingest_.put("b", agents[1].second);
  EXPECT_EQ(ingest_.loaded(loaded_incarnation(file, "q1")), 0);
  EXPECT_EQ(code_of(ingest_.from_archive(file, "q2")), Code::kExists);
}

TEST_F(IngestTest, a_damaged_file_is_refused) {
  Bytes file = write_octomap_file(wall_, kResolution, OctomapFormat::kBinary).value();
  file.pop_back();
  EXPECT_EQ(code_of(ingest_.from_file("archive", "hall", file)), Code::kMalformed);
}

RC_GTEST_PROP(IngestProperty, the_changes_tell_everything, ()) {
  Ingest ingest(kConfig);
  Mirror mirror;
  const auto apply = [&](const Change& change) { mirror.apply(change, ingest.find("a")->layer); };
  for (int step = 0; step < 20; ++step) {
    const std::string frame = numbered("f", *rc::gen::inRange(0, 3));
    const VoxelIndex low{*rc::gen::inRange(-20, 20), *rc::gen::inRange(-20, 20), 0};
    const BrickMap map =
        box(low, {low.x + *rc::gen::inRange(0, 12), low.y + 3, 3}, *rc::gen::element(kFree, kOccupied));
    switch (*rc::gen::inRange(0, 5)) {
      case 0:
        if (auto change = ingest.take_octomap("a", frame, octomap_of(map), OctomapFormat::kFull, kResolution))
          apply(*change);
        break;
      case 1: {
        const auto change = ingest.begin_stream("a", frame);
        if (!change) break;
        apply(*change);
        for (const BrickIndex index : map.sorted_bricks()) {
          if (ingest.set_brick("a", index, *map.find(index)).value()) apply({false, {index}});
        }
        break;
      }
      case 2:
        if (auto taken = ingest.take_cloud("a", frame, {1, step},
                                           {std::nullopt, 0, {{0.1F * low.x, 0.1F * low.y, 0.05F}}}, step)) {
          apply(taken->change);
        }
        break;
      case 3:
        if (auto after = ingest.after_reset("a")) apply(ingest.put("a", std::move(*after)));
        break;
      default:
        if (ingest.find("a") != nullptr) {
          ingest.remove("a");
          mirror = {};
        }
    }
    const Agent* agent = ingest.find("a");
    const BrickMap layer = agent != nullptr ? agent->layer : BrickMap();
    const std::int64_t known = agent != nullptr ? agent->known() : 0;
    RC_ASSERT(mirror.map() == layer);
    RC_ASSERT(known == static_cast<std::int64_t>(layer.known_count()));
  }
}

}  // namespace
}  // namespace concord
