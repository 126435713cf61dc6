#include <sys/resource.h>
#include <unistd.h>

#include <csignal>

#include "core/octomap_reader.hpp"
#include "people_station.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

class PeopleMapTest : public PeopleStation {};

TEST_F(PeopleMapTest, TheHistoryIsToldInPartsThatFit) {
  send_wall();
  ASSERT_TRUE(place("t1", Transform::Identity()).ok);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(add("edit" + std::to_string(i), {i, 0, 5}).ok);
  ASSERT_TRUE(undo("u1", "edit7").ok);
  HistoryRequest all;
  all.id = "h1";
  const Answer told = history(all);
  EXPECT_TRUE(told.ok);
  EXPECT_EQ(told.count, 102);
  ASSERT_GT(histories_.size(), 5u);
  std::vector<Operation> operations;
  for (const HistoryPart& part : histories_) {
    EXPECT_EQ(part.id, "h1");
    EXPECT_EQ(part.parts, static_cast<std::int32_t>(histories_.size()));
    operations.insert(operations.end(), part.operations.begin(), part.operations.end());
  }
  ASSERT_EQ(operations.size(), 102u);
  for (std::size_t i = 0; i < operations.size(); ++i) EXPECT_EQ(operations[i].revision, static_cast<int>(i) + 1);
  EXPECT_EQ(operations[0].kind, Operation::Kind::kTransform);
  EXPECT_FALSE(operations[8].active) << "edit7 is undone";
  HistoryRequest one;
  one.id = "h2";
  one.subject = "edit7";
  EXPECT_EQ(history(one).count, 2);
  one.id = "h3";
  one.subject = "nothing";
  EXPECT_EQ(history(one).count, 0);
  EXPECT_EQ(histories_.size(), 1u) << "an empty part says so";
}

TEST_F(PeopleMapTest, ConflictsEndByAnEditByNewerDataAndByMoving) {
  send_wall();
  ASSERT_TRUE(place("t1", Transform::Identity()).ok);
  send_second(kFree);
  ASSERT_TRUE(place_second("t2", Transform::Identity()).ok);
  ASSERT_TRUE(ask_conflicts("c1").ok);
  ASSERT_EQ(conflicts_.size(), 1u);
  ASSERT_EQ(conflicts_[0].regions.size(), 1u);
  EXPECT_EQ(conflicts_[0].voxels_in_all, 8);
  const ConflictRegion& region = conflicts_[0].regions[0];
  EXPECT_EQ(region.min, (VoxelIndex{16, 0, 0}));
  EXPECT_EQ(region.max, (VoxelIndex{23, 0, 0}));
  ASSERT_EQ(region.claims.size(), 2u);
  EXPECT_EQ(region.claims[0].agent, "robot1");
  EXPECT_EQ(region.claims[0].occupied, 8);
  EXPECT_EQ(region.claims[1].free, 8);

  ASSERT_TRUE(add("e1", {16, 0, 0}).ok);
  ask_conflicts("c2");
  EXPECT_EQ(conflicts_[0].voxels_in_all, 7) << "a person decided";
  ASSERT_TRUE(undo("u1", "e1").ok);
  ask_conflicts("c3");
  EXPECT_EQ(conflicts_[0].voxels_in_all, 8);
  send_second(kOccupied);
  ask_conflicts("c4");
  EXPECT_EQ(conflicts_[0].regions_in_all, 0) << "newer data agrees";
  send_second(kFree);
  ask_conflicts("c5");
  EXPECT_EQ(conflicts_[0].voxels_in_all, 8);
  ASSERT_TRUE(place_second("t3", at(0, 50)).ok);
  ask_conflicts("c6");
  EXPECT_EQ(conflicts_[0].regions_in_all, 0) << "it lies elsewhere";
  EXPECT_TRUE(node_->conflicts().empty());
}

TEST_F(PeopleMapTest, AVanishedObstacleGoesWhenItsAgentMapsThePlaceAgain) {
  send_wall();
  ASSERT_TRUE(place("t1", Transform::Identity()).ok);
  run();
  ASSERT_TRUE(is_occupied(heard_.at({16, 0, 0})));
  VoxelMask mask{};
  mask[0] = 0xFF;
  agent_map_.set(BrickIndex{2, 0, 0}, Brick::uniform(mask, kFree));
  agent_stream_->touch(BrickIndex{2, 0, 0});
  run();
  EXPECT_TRUE(is_free(heard_.at({16, 0, 0})));
  EXPECT_EQ(digest(heard_), digest(node_->map()));
}

TEST_F(PeopleMapTest, EditsOutliveReAlignmentAndRemoval) {
  send_wall();
  ASSERT_TRUE(place("t1", Transform::Identity()).ok);
  EditRequest erase = edit_of("e1", "eva", {16, 0, 0});
  erase.op = EditRequest::Op::kDelete;
  ASSERT_TRUE(edit(erase).ok);
  ASSERT_TRUE(place("t2", at(5, 0, 0.3)).ok);
  EXPECT_EQ(node_->map().at({16, 0, 0}), kPinnedFree);
  ASSERT_TRUE(place("t3", Transform::Identity()).ok);
  EXPECT_EQ(node_->map().at({16, 0, 0}), kPinnedFree);
  EXPECT_EQ(node_->map().at({17, 0, 0}), kOccupied);
  agent_stream_->end();
  run();
  EXPECT_EQ(node_->map().known_count(), 1u) << "what a person pinned, and no ghost";
  EXPECT_EQ(digest(heard_), digest(node_->map()));
}

TEST_F(PeopleMapTest, OneIdIsOneCorrectionWhateverItsKind) {
  send_wall();
  ASSERT_TRUE(place("one", Transform::Identity()).ok);
  EXPECT_EQ(add("one", {0, 0, 0}).code, "EXISTS");
  EXPECT_EQ(weigh("one", "robot1", 3).code, "EXISTS");
  EXPECT_EQ(zone("one", "eva", ZoneRequest::Op::kAdd, "door").code, "EXISTS");
  start();
  agent_stream_->begin("frame1");
  run();
  EXPECT_EQ(add("one", {0, 0, 0}).code, "EXISTS");
  EXPECT_EQ(place("one", Transform::Identity()).revision, 1);
}

/// Files cannot grow beyond `bytes` while this lives, as on a full disk.
class FullDisk {
 public:
  explicit FullDisk(std::uintmax_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
};

TEST_F(PeopleMapTest, OnAFullDiskNothingChangesAndAllIsServed) {
  send_wall();
  ASSERT_TRUE(place("t1", Transform::Identity()).ok);
  ASSERT_TRUE(add("e1", {0, 0, 0}).ok);
  ASSERT_TRUE(zone("z1", "eva", ZoneRequest::Op::kAdd, "door").ok);
  run();
  const std::uint64_t before = digest(node_->map());
  {
    const FullDisk full(std::filesystem::file_size(site_.state / "merge.db-wal"));
    EXPECT_EQ(add("e2", {0, 0, 1}).code, "IO");
    EXPECT_EQ(undo("u1", "e1").code, "IO");
    EXPECT_EQ(zone("z2", "eva", ZoneRequest::Op::kDelete, "door").code, "IO");
    EXPECT_EQ(place("t2", at(1, 0)).code, "IO");
    EXPECT_EQ(weigh("w1", "robot1", 9).code, "IO");
    EXPECT_TRUE(add("e1", {0, 0, 0}).ok) << "what is there already needs no disk";
    EXPECT_TRUE(lease("l1", "eva", true).ok);
    HistoryRequest all;
    all.id = "h1";
    EXPECT_EQ(history(all).count, 3);
    EXPECT_EQ(digest(node_->map()), before);
    EXPECT_EQ(zones_->items().size(), 1u);
  }
  EXPECT_EQ(add("e2", {0, 0, 1}).revision, 4) << "no revision was used up";
  EXPECT_EQ(undo("u1", "e1").revision, 5);
  start();
  agent_stream_->begin("frame1");
  run();
  EXPECT_EQ(node_->map().at({0, 0, 1}), kPinnedOccupied);
  EXPECT_EQ(node_->map().at({0, 0, 0}), kUnknown);
}

TEST_F(PeopleMapTest, AStateFolderThatBecomesReadOnlyRefusesMapsAndServesOn) {
  std::filesystem::permissions(site_.state, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const bool is_root = ::geteuid() == 0;  // who may write anywhere
  ASSERT_TRUE(!is_root || ::seteuid(65534) == 0);
  const MapRequest save{"s1", MapRequest::Op::kSave, "hall", {"bt"}, false, ""};
  EXPECT_EQ(ask("in/map_request", encode(save, bus_->now())).code, "IO");
  EXPECT_TRUE(add("e1", {0, 0, 0}).ok) << "its files are open";
  ASSERT_TRUE(!is_root || ::seteuid(0) == 0);
  std::filesystem::permissions(site_.state, std::filesystem::perms::owner_all);
  let_refusals_pass();
  EXPECT_TRUE(ask("in/map_request", encode(save, bus_->now())).ok);
}

}  // namespace
}  // namespace concord
