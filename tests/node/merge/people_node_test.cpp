#include <stdexcept>

#include "bus/messages_map.hpp"
#include "merge/merge_schema.hpp"
#include "people_station.hpp"
#include "store/database.hpp"

namespace concord {
namespace {

class PeopleNodeTest : public PeopleStation {};

TEST_F(PeopleNodeTest, WhoWasToldNoHasItNotDoneByACopyThatWasUnderWay) {
  ASSERT_TRUE(lease("corner", "eva", true).ok);
  const EditRequest toms = edit_of("e1", "tom", {5, 5, 5});
  ASSERT_EQ(edit(toms).code, "LOCKED");
  ASSERT_TRUE(lease("corner", "eva", false).ok);
  EXPECT_EQ(edit(toms).code, "LOCKED") << "the same answer to the same request";
  EXPECT_TRUE(node_->map().empty());
  run(2'000'000);
  EXPECT_TRUE(edit(toms).ok) << "asked again";
}

TEST_F(PeopleNodeTest, AStoreThatNobodyCouldHaveWrittenIsToldAtTheStart) {
  ASSERT_TRUE(add("e1", {1, 1, 1}).ok);
  ASSERT_TRUE(undo("u1", "e1").ok);
  node_.reset();
  {
    Database store(site_.state / "merge.db", kMergeSchema);
    ASSERT_TRUE(store.prepare("UPDATE corrections SET subject = 'nobody' WHERE id = 'u1'").run());
  }
  try {
    start();
    FAIL() << "it started";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("bring back a backup"), std::string::npos) << error.what();
  }
}

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

TEST_F(PeopleNodeTest, SaysSinceWhenTheMapHoldsWhatWasMade) {
  std::vector<MapEdits> said;
  bus_->subscribe("out/map_edits", [&](const std::string&, auto bytes) { said.push_back(*decode<MapEdits>(bytes)); });
  const Answer first = add("e1", {1, 1, 1});
  ASSERT_TRUE(first.ok);
  ASSERT_FALSE(said.empty()) << "at once";
  EXPECT_EQ(said.back().edit_revision, first.revision);
  run();
  EXPECT_EQ(said.back().map_revision, listener_->revision());
  EXPECT_EQ(said.back().map_revision, listener_->whole_revision());
  const auto before = said.back();
  const std::size_t count = said.size();
  run(2'000'000);
  EXPECT_GT(said.size(), count) << "and each second";
  const std::int64_t undone = undo("u1", "e1").revision;
  EXPECT_EQ(said.back().edit_revision, undone);
  EXPECT_GT(said.back().map_revision, before.map_revision);
  EXPECT_EQ(said.back().boot_id, before.boot_id);
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
  let_refusals_pass();
  EXPECT_EQ(edit(request).code, "NOT_ALIGNED");
  request.frame.frame_id = "hall";
  EXPECT_EQ(edit(request).code, "BAD_FRAME");
  ASSERT_TRUE(ask("in/transform", encode(TransformRequest{"t1", "eva", "hmd1", "", at(3, 0)}, bus_->now())).ok);
  request.frame.frame_id = "room";
  let_refusals_pass();
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
  let_refusals_pass();
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

TEST_F(PeopleNodeTest, ATextOverItsLimitIsAnsweredAndCounted) {
  const Answer refused = zone("z1", "eva", ZoneRequest::Op::kAdd, std::string(1000, 'x'));
  EXPECT_EQ(refused.id, "z1");
  EXPECT_EQ(refused.code, "TOO_LARGE");
  EXPECT_EQ(counters_.get("refused.in/zone.TOO_LARGE"), 1);
}

TEST_F(PeopleNodeTest, LeasesKeepOthersOutUntilTheyAreOver) {
  ASSERT_TRUE(lease("l1", "eva", true).ok);
  run(100'000);
  ASSERT_EQ(leases_->items().size(), 1u);
  EXPECT_EQ(leases_->items()[0].author, "eva");
  EXPECT_EQ(edit(edit_of("b1", "tom", {5, 5, 5})).code, "LOCKED");
  EXPECT_EQ(zone("z1", "tom", ZoneRequest::Op::kAdd, "door").code, "LOCKED");
  const Answer locked = lease("l2", "tom", true);
  EXPECT_EQ(locked.code, "LOCKED");
  EXPECT_NE(locked.message.find("eva holds lease 'l1' for "), std::string::npos) << locked.message;
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

}  // namespace
}  // namespace concord
