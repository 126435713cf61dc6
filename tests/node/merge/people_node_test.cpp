#include <sys/resource.h>
#include <unistd.h>

#include <csignal>

#include "core/octomap_reader.hpp"
#include "merge_station.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

Box box(double low, double high) { return {Eigen::Vector3d::Constant(low), Eigen::Vector3d::Constant(high)}; }

Transform at(double x, double y, double yaw = 0) {
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(x, y, 0);
  return T;
}

class PeopleNodeTest : public MergeStation {
 protected:
  Answer zone(const std::string& id, const std::string& author, ZoneRequest::Op op, const std::string& name,
              Volume volume = box(0, 1), WorkFrame frame = {}) {
    return ask("in/zone", encode(ZoneRequest{id, author, op, name, Zone::Kind::kNoGo, volume, frame, -1, bus_->now()}));
  }
  Answer lease(const std::string& id, const std::string& author, bool hold, Volume volume = box(0, 1)) {
    return ask("in/lease", encode(LeaseRequest{id, author, hold, volume, {}, bus_->now()}));
  }
  Answer weigh(const std::string& id, const std::string& agent, int weight) {
    return ask("in/weight", encode(WeightRequest{id, "eva", agent, weight, bus_->now()}));
  }
  Answer history(const HistoryRequest& request) {
    histories_.clear();
    answers_.clear();
    bus_->publish("in/history_request", encode(request, bus_->now()));
    run(2'000'000);
    return answers_.empty() ? Answer{} : answers_.back();
  }
  Answer ask_conflicts(const std::string& id, int most = 100) {
    conflicts_.clear();
    answers_.clear();
    bus_->publish("in/conflict_request", encode(ConflictRequest{id, most}, bus_->now()));
    run(100'000);
    return answers_.empty() ? Answer{} : answers_.back();
  }
  /// A second agent that has one brick.
  void send_second(LogOdds value, std::uint64_t bits = 0xFF) {
    VoxelMask mask{};
    mask[0] = bits;
    second_map_.set(BrickIndex{2, 0, 0}, Brick::uniform(mask, value));
    if (!second_) {
      second_ = std::make_unique<BrickSender>(
          *bus_, counters_, BrickSender::Config{"out/agent/robot2", site_.resolution, 5e6, bus_->now(), 1},
          second_map_);
      second_->begin("frame1");
    } else {
      second_->touch(BrickIndex{2, 0, 0});
    }
    run();
  }
  Answer place_second(const std::string& id, const Transform& T) {
    return ask("in/transform", encode(TransformRequest{id, "eva", "robot2", "", T}, bus_->now()));
  }
  void restart() {
    second_.reset();
    start();
    run();
  }

  BrickMap second_map_;
  std::unique_ptr<BrickSender> second_;
};

TEST_F(PeopleNodeTest, UndoShowsWhatTheSensorsSay) {
  send_wall();
  ASSERT_TRUE(place("t1", Transform::Identity()).ok);
  const std::uint64_t before = digest(node_->map());
  EditRequest erase = edit_of("e1", "eva", {16, 0, 0});
  erase.op = EditRequest::Op::kDelete;
  const Answer erased = edit(erase);
  ASSERT_TRUE(erased.ok) << erased.message;
  EXPECT_EQ(erased.revision, 2);
  EXPECT_EQ(erased.count, 1);
  EXPECT_EQ(node_->map().at({16, 0, 0}), kPinnedFree);
  EXPECT_EQ(undo("u1", "e1").revision, 3);
  EXPECT_EQ(digest(node_->map()), before);
  EXPECT_EQ(undo("u2", "e1").code, "CONFLICT");
  EXPECT_EQ(undo("u2", "nothing").code, "NOT_FOUND");
  EXPECT_EQ(undo("u1", "e1").revision, 3) << "asked twice is done once";
  EXPECT_EQ(undo("u1", "e1", true).code, "EXISTS");
  EXPECT_EQ(undo("u3", "e1", true).revision, 4);
  EXPECT_EQ(node_->map().at({16, 0, 0}), kPinnedFree);
  start();
  agent_stream_->begin("frame1");
  run();
  EXPECT_EQ(node_->map().at({16, 0, 0}), kPinnedFree);
  EXPECT_EQ(undo("u1", "e1").revision, 3) << "still after a restart";
  EXPECT_EQ(undo("u1", "e1", true).code, "EXISTS");
  EXPECT_EQ(undo("u4", "e1").revision, 5);
  EXPECT_EQ(digest(node_->map()), before);
}

TEST_F(PeopleNodeTest, AnEditInAHeadsetsFrameIsPutIntoTheMap) {
  EditRequest request = edit_of("e1", "eva", {0, 0, 0});
  request.frame = {"hmd1", ""};
  Line line;
  line.points = {{0.05, 0.05, 0.05}, {0.05, 0.05, 0.05}};
  request.shape = line;
  EXPECT_EQ(edit(request).code, "NO_AGENT");
  bus_->publish("in/hmd1/pose", encode(AgentPose{"", "room", Transform::Identity(), 5}));
  bus_->deliver();
  EXPECT_EQ(edit(request).code, "NOT_ALIGNED");
  request.frame.frame_id = "hall";
  EXPECT_EQ(edit(request).code, "BAD_FRAME");
  ASSERT_TRUE(ask("in/transform", encode(TransformRequest{"t1", "eva", "hmd1", "", at(3, 0)}, bus_->now())).ok);
  request.frame.frame_id = "room";
  EXPECT_TRUE(edit(request).ok);
  EXPECT_EQ(node_->map().at({30, 0, 0}), kPinnedOccupied);
}

TEST_F(PeopleNodeTest, AMoveTakesWhatIsThereNow) {
  send_wall();
  ASSERT_TRUE(place("t1", Transform::Identity()).ok);
  EditRequest move = edit_of("m1", "eva", {16, 0, 0});
  move.op = EditRequest::Op::kMove;
  move.move = {0, 0, 0.3};
  ASSERT_TRUE(add("e1", {16, 0, 3}).ok);
  EXPECT_EQ(edit(move).code, "COLLISION");
  ASSERT_TRUE(undo("u1", "e1").ok);
  const Answer moved = edit(move);
  EXPECT_TRUE(moved.ok) << moved.message;
  EXPECT_EQ(moved.count, 2);
  EXPECT_EQ(node_->map().at({16, 0, 0}), kPinnedFree);
  EXPECT_EQ(node_->map().at({16, 0, 3}), kPinnedOccupied);
  EXPECT_EQ(edit(move).revision, moved.revision) << "not done again from where it is now";
  move.id = "m2";
  EXPECT_EQ(edit(move).code, "EMPTY");
  move.shape = VoxelList{site_.resolution, {{{17, 0, 0}, {17, 0, 0}}}};
  move.move = {0, 0, 5000};
  EXPECT_EQ(edit(move).code, "OUT_OF_BOUNDS");
}

TEST_F(PeopleNodeTest, TwoPeopleInterleaved) {
  ASSERT_EQ(edit(edit_of("a1", "eva", {0, 0, 0})).revision, 1);
  EditRequest toms = edit_of("b1", "tom", {0, 0, 0});
  toms.op = EditRequest::Op::kDelete;
  toms.base_revision = 0;
  EXPECT_EQ(edit(toms).code, "STALE_REV");
  EXPECT_EQ(counters_.get("refused.in/edit.STALE_REV"), 1);
  toms.base_revision = 1;
  EXPECT_EQ(edit(toms).revision, 2) << "the refused id may be used again";
  EditRequest evas = edit_of("a2", "eva", {0, 0, 1});
  evas.base_revision = 1;
  EXPECT_EQ(edit(evas).revision, 3) << "tom changed another voxel";
  evas = edit_of("a3", "eva", {0, 0, 0});
  evas.base_revision = 1;
  EXPECT_EQ(edit(evas).code, "STALE_REV");
  evas.base_revision = 99;
  EXPECT_EQ(edit(evas).code, "BAD_REQUEST");
  run();
  EXPECT_EQ(heard_.at({0, 0, 0}), kPinnedFree);
  EXPECT_EQ(heard_.at({0, 0, 1}), kPinnedOccupied);
}

TEST_F(PeopleNodeTest, HostileEditsAreRefusedAndCounted) {
  EditRequest million = edit_of("e1", "eva", {0, 0, 0});
  million.shape = VoxelList{site_.resolution, {{{0, 0, 0}, {99, 99, 99}}}};
  EXPECT_EQ(edit(million).code, "TOO_LARGE");
  EXPECT_EQ(edit(edit_of("e1", "eva", {std::numeric_limits<std::int32_t>::max(), 0, 0})).code, "OUT_OF_BOUNDS");
  EXPECT_EQ(edit(edit_of("e1", "eva", {std::numeric_limits<std::int32_t>::min(), 0, 0})).code, "OUT_OF_BOUNDS");
  EditRequest nan = edit_of("e1", "eva", {0, 0, 0});
  nan.shape = box(std::nan(""), 1);
  EXPECT_EQ(edit(nan).code, "NOT_FINITE");
  EXPECT_EQ(counters_.get("refused.in/edit.TOO_LARGE") + counters_.get("refused.in/edit.OUT_OF_BOUNDS") +
                counters_.get("refused.in/edit.NOT_FINITE"),
            4);
  EXPECT_TRUE(node_->map().empty());
  EXPECT_EQ(add("e1", {0, 0, 0}).revision, 1);
}

TEST_F(PeopleNodeTest, ZonesAreHeardAndOutliveARestart) {
  ASSERT_TRUE(zone("z1", "eva", ZoneRequest::Op::kAdd, "door").ok);
  EXPECT_EQ(zone("z2", "tom", ZoneRequest::Op::kAdd, "door").code, "EXISTS");
  EXPECT_EQ(zone("z2", "tom", ZoneRequest::Op::kDelete, "gate").code, "NOT_FOUND");
  EXPECT_EQ(zone("z2", "tom", ZoneRequest::Op::kAdd, "gate", box(0, 1), {"hmd1", ""}).code, "NO_AGENT");
  ASSERT_TRUE(zone("z2", "tom", ZoneRequest::Op::kAdd, "gate").ok);
  run();
  ASSERT_EQ(zones_->items().size(), 2u);
  EXPECT_EQ(zones_->items()[0].name, "door");
  EXPECT_EQ(zones_->items()[0].author, "eva");
  restart();
  ASSERT_EQ(zones_->items().size(), 2u);
  EXPECT_EQ(zones_->items()[1].revision, 2);
  EXPECT_EQ(zone("z1", "eva", ZoneRequest::Op::kAdd, "door").revision, 1) << "the same request";
  ASSERT_TRUE(zone("z3", "eva", ZoneRequest::Op::kChange, "door", box(2, 3)).ok);
  ASSERT_TRUE(zone("z4", "eva", ZoneRequest::Op::kDelete, "gate").ok);
  run();
  ASSERT_EQ(zones_->items().size(), 1u);
  EXPECT_EQ(std::get<Box>(zones_->items()[0].volume).min.x(), 2);
}

TEST_F(PeopleNodeTest, LeasesKeepOthersOutUntilTheyAreOver) {
  ASSERT_TRUE(lease("l1", "eva", true).ok);
  run(100'000);
  ASSERT_EQ(leases_->items().size(), 1u);
  EXPECT_EQ(leases_->items()[0].author, "eva");
  EXPECT_EQ(edit(edit_of("b1", "tom", {5, 5, 5})).code, "LOCKED");
  EXPECT_EQ(zone("z1", "tom", ZoneRequest::Op::kAdd, "door").code, "LOCKED");
  EXPECT_EQ(lease("l2", "tom", true).code, "LOCKED");
  EXPECT_TRUE(edit(edit_of("a1", "eva", {5, 5, 5})).ok);
  const Bytes toms_undo = encode(UndoRequest{"u1", "tom", "a1", false, 0});
  EXPECT_EQ(ask("in/undo", toms_undo).code, "LOCKED");
  run(8'000'000);
  EXPECT_TRUE(lease("l1", "eva", true).ok) << "renewed";
  run(8'000'000);
  EXPECT_EQ(edit(edit_of("b1", "tom", {5, 5, 5})).code, "LOCKED");
  run(3'000'000);
  EXPECT_TRUE(leases_->items().empty());
  EXPECT_TRUE(edit(edit_of("b1", "tom", {5, 5, 5})).ok);
  EXPECT_TRUE(lease("l2", "tom", true).ok);
  EXPECT_EQ(lease("l2", "eva", false).code, "LOCKED") << "tom's";
  EXPECT_TRUE(lease("l2", "tom", false).ok);
  EXPECT_EQ(lease("l2", "tom", false).count, 0) << "freed twice is free";
  restart();
  EXPECT_TRUE(leases_->items().empty());
}

TEST_F(PeopleNodeTest, AWeightOverridesTheSiteFile) {
  send_wall();
  ASSERT_TRUE(place("t1", Transform::Identity()).ok);
  send_second(-1000);
  ASSERT_TRUE(place_second("t2", Transform::Identity()).ok);
  EXPECT_EQ(node_->map().at({16, 0, 0}), (kOccupied - 1000) / 2);
  EXPECT_EQ(weigh("w1", "nobody", 3).code, "NO_AGENT");
  EXPECT_EQ(weigh("w1", "robot2", 3).revision, 3);
  EXPECT_EQ(node_->map().at({16, 0, 0}), (kOccupied - 3000) / 4);
  run();
  EXPECT_EQ(agents_.agents[1].weight, 3);
  EXPECT_EQ(digest(heard_), digest(node_->map()));
  second_.reset();
  start();
  agent_stream_->begin("frame1");
  send_second(-1000);
  EXPECT_EQ(node_->map().at({16, 0, 0}), (kOccupied - 3000) / 4) << "for good";
}

TEST_F(PeopleNodeTest, ARobotThatIsSeenIsPlacedThroughItsPoseOfThatTime) {
  const auto localise = [&](const std::string& id, std::int64_t utime, WorkFrame frame = {}) {
    return ask("in/localise", encode(LocaliseRequest{id, "eva", "robot2", at(10, 5, 1), frame, utime}));
  };
  EXPECT_EQ(localise("l1", 0).code, "NO_AGENT");
  for (int i = 0; i <= 10; ++i) {
    bus_->publish("in/robot2/pose", encode(AgentPose{"", "odom", at(i, 0), 1'000'000 + i * 100'000}));
  }
  bus_->deliver();
  EXPECT_EQ(localise("l1", 5'000'000).code, "STALE");
  EXPECT_EQ(localise("l1", 1'450'000, {"hmd1", ""}).code, "NO_AGENT");
  const Answer placed = localise("l1", 1'450'000);
  ASSERT_TRUE(placed.ok) << placed.message;
  run();
  ASSERT_TRUE(agents_.agents[0].aligned);
  EXPECT_TRUE((agents_.agents[0].T_map_agent * at(4.5, 0)).isApprox(at(10, 5, 1), 1e-9));
  EXPECT_EQ(localise("l1", 1'450'000).revision, placed.revision);
  EXPECT_EQ(localise("l1", 1'500'000).code, "EXISTS") << "seen at another time";
  restart();
  EXPECT_EQ(localise("l1", 1'450'000).revision, placed.revision);
}

TEST_F(PeopleNodeTest, TheHistoryIsToldInPartsThatFit) {
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

TEST_F(PeopleNodeTest, ConflictsEndByAnEditByNewerDataAndByMoving) {
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

TEST_F(PeopleNodeTest, AVanishedObstacleGoesWhenItsAgentMapsThePlaceAgain) {
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

TEST_F(PeopleNodeTest, EditsOutliveReAlignmentAndRemoval) {
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

TEST_F(PeopleNodeTest, OneIdIsOneCorrectionWhateverItsKind) {
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

TEST_F(PeopleNodeTest, OnAFullDiskNothingChangesAndAllIsServed) {
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

TEST_F(PeopleNodeTest, AStateFolderThatBecomesReadOnlyRefusesMapsAndServesOn) {
  std::filesystem::permissions(site_.state, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const bool is_root = ::geteuid() == 0;  // who may write anywhere
  ASSERT_TRUE(!is_root || ::seteuid(65534) == 0);
  const MapRequest save{"s1", MapRequest::Op::kSave, "hall", "bt", false, ""};
  EXPECT_EQ(ask("in/map_request", encode(save, bus_->now())).code, "IO");
  EXPECT_TRUE(add("e1", {0, 0, 0}).ok) << "its files are open";
  ASSERT_TRUE(!is_root || ::seteuid(0) == 0);
  std::filesystem::permissions(site_.state, std::filesystem::perms::owner_all);
  EXPECT_TRUE(ask("in/map_request", encode(save, bus_->now())).ok);
}

}  // namespace
}  // namespace concord
