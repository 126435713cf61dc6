#include "ingest/layer_store.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <optional>

#include "layers.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;
using testing::box;
using testing::kResolution;
using testing::numbered;
using testing::octomap_of;

class LayerStoreTest : public ::testing::Test {
 protected:
  LayerStoreTest() {
    std::string pattern = (fs::temp_directory_path() / "concord-layers-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    open();
  }
  ~LayerStoreTest() override {
    store_.reset();
    fs::remove_all(folder_);
  }

  void open() {
    store_.reset();
    store_.emplace(folder_ / "ingest.db", kResolution);
  }
  void octomap(const std::string& id, const std::string& frame, const BrickMap& map) {
    const Change change = ingest_.take_octomap(id, frame, octomap_of(map), OctomapFormat::kFull, kResolution).value();
    store_->note(id, *ingest_.find(id), change);
  }
  void flush() { ASSERT_TRUE(store_->flush(ingest_.agents())); }
  /// What a new start finds.
  LayerStore::Loaded reload() {
    open();
    return store_->load().value();
  }
  /// Runs SQL on the file behind the store's back.
  void tamper(const std::string& sql) {
    store_.reset();
    ASSERT_TRUE(Database(folder_ / "ingest.db", std::array{""}).execute(sql));
  }

  fs::path folder_;
  std::optional<LayerStore> store_;
  Ingest ingest_{Ingest::Config{.resolution = kResolution}};
  const BrickMap wall_ = box({-3, -20, 0}, {20, 0, 9}, kOccupied);
  const BrickMap floor_ = box({-9, -9, 0}, {20, 9, 0}, -100);
};

TEST_F(LayerStoreTest, layers_come_back_whole) {
  octomap("robot1", "f", wall_);
  octomap("robot2", "g", floor_);
  flush();
  EXPECT_EQ(store_->to_write(), 0U);
  const auto loaded = reload();
  ASSERT_EQ(loaded.agents.size(), 2U);
  EXPECT_TRUE(loaded.refused.empty());
  EXPECT_EQ(loaded.agents[0].first, "robot1");
  EXPECT_EQ(loaded.agents[0].second.layer, wall_);
  EXPECT_EQ(loaded.agents[0].second.known(), static_cast<std::int64_t>(wall_.known_count()));
  EXPECT_EQ(loaded.agents[0].second.frame_id, "f");
  EXPECT_EQ(loaded.agents[0].second.source, Source::kOctomap);
  EXPECT_EQ(loaded.agents[1].second.layer, floor_);
}

TEST_F(LayerStoreTest, only_what_was_flushed_survives_a_kill) {
  octomap("robot1", "f", wall_);
  flush();
  store_.reset();
  const pid_t child = ::fork();
  if (child == 0) {
    open();
    octomap("robot1", "f", floor_);
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(child, nullptr, 0);
  EXPECT_EQ(reload().agents.at(0).second.layer, wall_);
}

TEST_F(LayerStoreTest, changes_are_written_brick_by_brick) {
  octomap("robot1", "f", wall_);
  flush();
  BrickMap next = wall_;
  next.set(wall_.sorted_bricks().front(), Brick{});
  next.set({9, 9, 9}, Brick::uniform({1}, kFree));
  octomap("robot1", "f", next);
  flush();
  EXPECT_EQ(reload().agents.at(0).second.layer, next);
}

TEST_F(LayerStoreTest, a_new_frame_replaces_the_rows_of_the_old_one) {
  octomap("robot1", "f", wall_);
  flush();
  octomap("robot1", "g", floor_);
  octomap("robot1", "g", box({0, 0, 0}, {1, 1, 1}, kFree));
  flush();
  const auto loaded = reload();
  EXPECT_EQ(loaded.agents.at(0).second.frame_id, "g");
  EXPECT_EQ(loaded.agents.at(0).second.layer, box({0, 0, 0}, {1, 1, 1}, kFree));
}

/// A layer of so many bricks that differ by `value`.
BrickMap bricks(int count, LogOdds value) {
  BrickMap map;
  for (int i = 0; i < count; ++i) map.set({i % 50, i / 50, 0}, Brick::uniform({1}, value));
  return map;
}

TEST_F(LayerStoreTest, a_large_layer_takes_several_slices_and_the_old_one_stands_until_the_last) {
  const auto large = static_cast<int>(5 * LayerStore::kSlice / 2);
  for (const char* frame : {"f", "g"}) {
    octomap("robot1", frame, wall_);
    flush();
    octomap("robot1", frame, bricks(large, kFree));  // "f": the first; "g": within its frame
    octomap("robot2", frame, floor_);
    for (int slice = 1; slice < 3; ++slice) {
      ASSERT_TRUE(store_->write_some(ingest_.agents()));
      EXPECT_GT(store_->to_write(), 0U);
    }
    const fs::path copy = folder_ / "copy";  // what a kill at this moment would leave
    fs::create_directories(copy);
    for (const char* file : {"ingest.db", "ingest.db-wal"}) {
      fs::copy_file(folder_ / file, copy / file, fs::copy_options::overwrite_existing);
    }
    LayerStore survivor(copy / "ingest.db", kResolution);
    auto loaded = survivor.load().value();
    ASSERT_GE(loaded.agents.size(), 1U);
    EXPECT_EQ(loaded.agents[0].second.layer, wall_) << "whole, as it was before";
    EXPECT_FALSE(survivor.is_idle()) << "what was half written is void";
    for (int i = 0; i < 10 && !survivor.is_idle(); ++i) ASSERT_TRUE(survivor.write_some({}));
    EXPECT_TRUE(survivor.is_idle());
    EXPECT_EQ(survivor.load().value().agents[0].second.layer, wall_);
    flush();
  }
  const auto loaded = reload();
  EXPECT_EQ(loaded.agents[0].second.layer, bricks(large, kFree));
  EXPECT_EQ(loaded.agents[0].second.frame_id, "g");
  EXPECT_EQ(loaded.agents[1].second.layer, floor_);
}

TEST_F(LayerStoreTest, what_changes_while_a_layer_is_written_is_in_it) {
  const auto large = static_cast<int>(2 * LayerStore::kSlice);
  octomap("robot1", "f", bricks(large, kFree));
  ASSERT_TRUE(store_->write_some(ingest_.agents()));
  octomap("robot1", "f", bricks(large - 10, kOccupied));
  flush();
  EXPECT_EQ(reload().agents.at(0).second.layer, bricks(large - 10, kOccupied));
  octomap("robot1", "g", bricks(large, kFree));
  ASSERT_TRUE(store_->write_some(ingest_.agents()));
  octomap("robot1", "h", bricks(large, kOccupied));
  flush();
  const auto loaded = reload();
  EXPECT_EQ(loaded.agents.at(0).second.frame_id, "h");
  EXPECT_EQ(loaded.agents.at(0).second.layer, bricks(large, kOccupied));
}

TEST_F(LayerStoreTest, a_busy_agent_does_not_keep_others_from_the_disk) {
  octomap("a", "f", wall_);
  octomap("b", "f", floor_);
  flush();
  const auto large = static_cast<int>(LayerStore::kSlice);
  for (int round = 0; round < 2; ++round) {
    octomap("a", "f", bricks(large, static_cast<LogOdds>(round)));
    octomap("b", "f", wall_);
    ASSERT_TRUE(store_->write_some(ingest_.agents()));
  }
  EXPECT_EQ(store_->load().value().agents.at(1).second.layer, wall_);
}

TEST_F(LayerStoreTest, a_reset_in_the_midst_of_writing_leaves_nothing_behind) {
  octomap("robot1", "f", bricks(static_cast<int>(2 * LayerStore::kSlice), kFree));
  ASSERT_TRUE(store_->write_some(ingest_.agents()));
  const Agent after = ingest_.after_reset("robot1").value();
  ASSERT_TRUE(store_->replace("robot1", &after));
  ingest_.put("robot1", after);
  for (int i = 0; i < 10 && !store_->is_idle(); ++i) ASSERT_TRUE(store_->write_some(ingest_.agents()));
  EXPECT_TRUE(store_->is_idle());
  open();
  EXPECT_TRUE(store_->is_idle());
  EXPECT_TRUE(store_->load().value().agents.at(0).second.layer.empty());
}

TEST_F(LayerStoreTest, the_numbers_of_clouds_come_back) {
  const auto taken = ingest_.take_cloud("robot1", "f", {17, 4}, {std::nullopt, 0, {{0.05F, 0.05F, 0.05F}}}, 1).value();
  store_->note("robot1", *ingest_.find("robot1"), taken.change);
  flush();
  const CloudNumber next = reload().agents.at(0).second.next_cloud;
  EXPECT_EQ(next.boot_id, 17);
  EXPECT_EQ(next.sequence, 5);
}

TEST_F(LayerStoreTest, a_reset_is_on_disk_at_once_and_its_frame_stays_dead) {
  octomap("robot1", "f", wall_);
  flush();
  octomap("robot1", "f", floor_);  // noted, not written: void by then
  const Agent after = ingest_.after_reset("robot1").value();
  ASSERT_TRUE(store_->replace("robot1", &after));
  EXPECT_EQ(store_->to_write(), 0U);
  const auto loaded = reload();
  const Agent& agent = loaded.agents.at(0).second;
  EXPECT_TRUE(agent.layer.empty());
  EXPECT_EQ(agent.dead_frames, (std::vector<std::string>{"f"}));
}

TEST_F(LayerStoreTest, layers_that_are_added_together_are_all_there_or_none_when_it_is_killed_in_their_midst) {
  const auto layer = [](LogOdds value) {
    Agent agent;
    agent.incarnation = 1;
    agent.frame_id = "f";
    agent.source = Source::kFile;
    agent.layer = bricks(50'000, value);
    return agent;
  };
  const std::vector<std::pair<std::string, Agent>> both{{"a", layer(kFree)}, {"b", layer(kOccupied)}};
  store_.reset();
  constexpr rlim_t kLogged = 1'000'000;
  const pid_t child = ::fork();
  if (child == 0) {
    // Pages go to the log before the commit, because they are more than its cache holds: the kernel kills it there.
    const rlimit no_core{0, 0};
    const rlimit logged{kLogged, kLogged};
    ::setrlimit(RLIMIT_CORE, &no_core);
    ::setrlimit(RLIMIT_FSIZE, &logged);
    ::signal(SIGXFSZ, SIG_DFL);
    open();
    (void)store_->add(both);
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGXFSZ) << "it was killed in the midst of writing";
  EXPECT_EQ(fs::file_size(folder_ / "ingest.db-wal"), kLogged);
  EXPECT_TRUE(reload().agents.empty());

  ASSERT_TRUE(store_->add(both));
  const auto loaded = reload();
  ASSERT_EQ(loaded.agents.size(), 2U);
  EXPECT_EQ(loaded.agents[0].second.layer, both[0].second.layer);
  EXPECT_EQ(loaded.agents[1].second.layer, both[1].second.layer);
  EXPECT_TRUE(store_->is_idle());
}

TEST_F(LayerStoreTest, removed_agents_are_remembered_up_to_a_number) {
  for (int i = 0; i < LayerStore::kMaxRemoved + 2; ++i) ASSERT_TRUE(store_->replace(numbered("r", i), nullptr));
  octomap("r5", "f", wall_);  // is back
  flush();
  const auto loaded = reload();
  EXPECT_EQ(loaded.removed.size(), LayerStore::kMaxRemoved - 1U);
  EXPECT_EQ(loaded.removed.front(), "r2");
  EXPECT_EQ(loaded.removed.back(), numbered("r", LayerStore::kMaxRemoved + 1));
  EXPECT_EQ(std::count(loaded.removed.begin(), loaded.removed.end(), "r5"), 0);
  EXPECT_EQ(loaded.agents.size(), 1U);
}

TEST_F(LayerStoreTest, damaged_bricks_are_told_and_the_rest_stands) {
  octomap("robot1", "f", wall_);
  octomap("robot2", "f", floor_);
  flush();
  tamper(
      "UPDATE brick SET voxels = x'ff' WHERE layer = 1 AND x = 0;"
      "INSERT INTO brick SELECT 1, 1000000000, y, z, voxels FROM brick WHERE layer = 2 LIMIT 1");
  const auto loaded = reload();
  ASSERT_EQ(loaded.refused.size(), 1U);
  EXPECT_EQ(loaded.refused[0].first, "robot1");
  EXPECT_EQ(loaded.refused[0].second.code, Code::kMalformed);
  BrickMap expected;
  wall_.for_each_brick([&](BrickIndex index, const Brick& brick) {
    if (index.x != 0) expected.set(index, brick);
  });
  EXPECT_EQ(loaded.agents.at(0).second.layer, expected);
  EXPECT_EQ(loaded.agents.at(1).second.layer, floor_);
}

TEST_F(LayerStoreTest, a_damaged_agent_does_not_keep_the_others_from_coming_back) {
  octomap("robot1", "f", wall_);
  octomap("robot2", "f", floor_);
  flush();
  tamper("UPDATE agent SET frame_id = '../x' WHERE id = 'robot1'");
  const auto loaded = reload();
  ASSERT_EQ(loaded.refused.size(), 1U);
  ASSERT_EQ(loaded.agents.size(), 1U);
  EXPECT_EQ(loaded.agents[0].first, "robot2");
}

TEST_F(LayerStoreTest, another_resolution_is_refused_at_start) {
  store_.reset();
  EXPECT_THROW(LayerStore(folder_ / "ingest.db", 2 * kResolution), std::runtime_error);
  EXPECT_NO_THROW(open());
}

TEST_F(LayerStoreTest, a_write_that_fails_writes_nothing_and_is_made_up_for) {
  tamper("CREATE TRIGGER full BEFORE INSERT ON brick WHEN new.x = 77 BEGIN SELECT RAISE(ABORT, 'no room'); END");
  open();
  octomap("robot1", "f", wall_);
  octomap("robot2", "f", box({77 * 8, 0, 0}, {77 * 8, 0, 0}, kFree));
  const auto failed = store_->flush(ingest_.agents());
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, Code::kIo);
  EXPECT_NE(failed.error().message.find("no room"), std::string::npos);
  EXPECT_GT(store_->to_write(), 0U);
  EXPECT_TRUE(store_->load().value().agents.empty());

  octomap("robot2", "f", wall_);
  flush();
  const auto loaded = reload();
  EXPECT_EQ(loaded.agents.at(0).second.layer, wall_);
  EXPECT_EQ(loaded.agents.at(1).second.layer, wall_);
}

}  // namespace
}  // namespace concord
