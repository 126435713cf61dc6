#include "core/map_archive.hpp"
#include "merge_station.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

Transform somewhere() {
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.1, 0.2, 1).normalized()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(1.0 / 3.0, -2, 0.1);
  return T;
}

/// The agent's stream says what ingest would once it has loaded the file.
class NativeMapTest : public MergeStation {
 protected:
  Answer ask_map(const std::string& id, MapRequest::Op op, bool overwrite = false) {
    return ask("in/map_request", encode(MapRequest{id, op, "hall", {"concord"}, overwrite, ""}, bus_->now()));
  }
  Answer load(const std::string& id) { return ask_map(id, MapRequest::Op::kLoad); }
  Answer zone(const std::string& id, const std::string& name) {
    const Box box{{0, 0, 0}, {1, 1, 1}};
    return ask("in/zone", encode(ZoneRequest{id, "eva", ZoneRequest::Op::kAdd, name, {}, box, {}, -1, 0}));
  }
  std::filesystem::path file() const { return site_.state / "maps/hall.concord"; }

  /// Somebody works, and saves; then everything begins anew in an empty folder that has just this file.
  void work_and_move() {
    send_wall();
    ASSERT_TRUE(place("t1", somewhere()).ok);
    ASSERT_TRUE(add("e1", {3, 0, 0}).ok);
    ASSERT_TRUE(add("e2", {3, 0, 1}).ok);
    ASSERT_TRUE(undo("u1", "e1").ok);
    ASSERT_TRUE(zone("z1", "door").ok);
    ASSERT_TRUE(ask("in/weight", encode(WeightRequest{"w1", "eva", "robot1", 7, 0})).ok);
    ASSERT_TRUE(ask_map("s1", MapRequest::Op::kSave).ok);
    run();
    map_ = node_->map();
    history_ = history();
    bytes_ = *read_whole_file(file(), 100'000);
    move();
  }
  void move() {
    node_.reset();
    std::filesystem::remove_all(site_.state);
    std::filesystem::create_directories(site_.state / "maps");
    ASSERT_TRUE(write_whole_file(file(), bytes_));
    start();
    run();
  }
  void load_layers(const std::string& request_id) {
    incarnation_ = loaded_incarnation(bytes_, request_id);
    start();
    agent_stream_->begin("frame1");
    run();
  }
  std::vector<Operation> history() {
    histories_.clear();
    HistoryRequest all;
    all.id = "h" + std::to_string(++asked_);
    ask("in/history_request", encode(all, bus_->now()));
    run();
    std::vector<Operation> out;
    for (const HistoryPart& part : histories_) out.insert(out.end(), part.operations.begin(), part.operations.end());
    return out;
  }

  BrickMap map_;
  std::vector<Operation> history_;
  Bytes bytes_;
  int asked_ = 0;
};

TEST_F(NativeMapTest, IntoAnEmptyStackItIsTheSameMapZonesAndHistory) {
  work_and_move();
  EXPECT_EQ(load("l1").code, "BUSY") << "ingest has not loaded it yet";
  EXPECT_TRUE(history().empty());
  load_layers("l1");
  const Answer loaded = load("l1");
  ASSERT_TRUE(loaded.ok) << loaded.message;
  EXPECT_EQ(loaded.count, 6);
  run();
  EXPECT_EQ(node_->map(), map_) << "to the byte";
  EXPECT_EQ(digest(heard_), digest(map_));
  ASSERT_EQ(zones_->items().size(), 1u);
  EXPECT_EQ(zones_->items()[0].name, "door");
  const auto after = history();
  ASSERT_EQ(after.size(), history_.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(after[i].revision, history_[i].revision);
    EXPECT_EQ(after[i].id, history_[i].id);
    EXPECT_EQ(after[i].author, history_[i].author);
    EXPECT_EQ(after[i].utime, history_[i].utime);
    EXPECT_EQ(after[i].kind, history_[i].kind);
    EXPECT_EQ(after[i].active, history_[i].active);
  }
}

TEST_F(NativeMapTest, AskedTwiceItIsDoneOnceAlsoAfterARestart) {
  work_and_move();
  load_layers("l1");
  const Answer loaded = load("l1");
  ASSERT_TRUE(loaded.ok) << loaded.message;
  EXPECT_EQ(load("l1").count, loaded.count);
  start();
  agent_stream_->begin("frame1");
  run();
  const Answer again = load("l1");
  EXPECT_TRUE(again.ok) << again.message;
  EXPECT_EQ(again.count, 0) << "nothing is left to do";
  EXPECT_EQ(node_->map(), map_);
  EXPECT_EQ(history().size(), history_.size());
}

TEST_F(NativeMapTest, WhereItsAgentsWereRemovedTheyComeBackToTheirPlaces) {
  work_and_move();
  load_layers("l1");
  ASSERT_TRUE(load("l1").ok);
  agent_stream_->end();
  run();
  load_layers("l2");
  EXPECT_NE(node_->map(), map_) << "not aligned";
  const Answer loaded = load("l2");
  ASSERT_TRUE(loaded.ok) << loaded.message;
  EXPECT_EQ(loaded.count, 1) << "just where it lies; all else is known";
  EXPECT_EQ(node_->map(), map_);
}

TEST_F(NativeMapTest, APlacementThatWasUndoneIsSoInTheFileToo) {
  send_wall();
  Transform elsewhere = somewhere();
  elsewhere.translation().x() += 1.0;
  for (const bool is_known_here : {false, true}) {
    const std::string n = is_known_here ? "1" : "0";
    ASSERT_TRUE(place("first" + n, somewhere()).ok);
    ASSERT_TRUE(place("second" + n, elsewhere).ok);
    ASSERT_TRUE(undo("undo" + n, "second" + n).ok);
    ASSERT_TRUE(ask_map("save" + n, MapRequest::Op::kSave, true).ok);
    run();
    const BrickMap before = node_->map();
    bytes_ = *read_whole_file(file(), 100'000);
    if (is_known_here) {
      agent_stream_->end();
      run();
    } else {
      move();
    }
    load_layers("load" + n);
    ASSERT_TRUE(load("load" + n).ok);
    run();
    EXPECT_EQ(node_->map(), before) << is_known_here;
    EXPECT_FALSE(before.empty());
  }
}

TEST_F(NativeMapTest, AWeightOfTheSiteFileThereIsKeptHere) {
  site_.agents["robot1"].weight = 5;
  start();
  send_wall();
  ASSERT_TRUE(place("t1", somewhere()).ok);
  ASSERT_TRUE(ask_map("s1", MapRequest::Op::kSave).ok);
  bytes_ = *read_whole_file(file(), 100'000);
  site_.agents.clear();
  move();
  load_layers("l1");
  ASSERT_TRUE(load("l1").ok);
  run();
  EXPECT_EQ(agents_.agents[0].weight, 5);
}

TEST_F(NativeMapTest, ATakenZoneNameOrIdRefusesAllOfIt) {
  work_and_move();
  ASSERT_TRUE(zone("mine", "door").ok);
  load_layers("l1");
  EXPECT_EQ(load("l1").code, "EXISTS");
  EXPECT_EQ(history().size(), 1u);
  EXPECT_FALSE(agents_.agents[0].aligned);
  move();
  ASSERT_TRUE(add("e1", {9, 9, 9}).ok);
  load_layers("l1");
  EXPECT_EQ(load("l1").code, "EXISTS") << "another edit has this id here";
  EXPECT_EQ(history().size(), 1u);
}

TEST_F(NativeMapTest, WhatWouldBeRefusedIsRefusedBeforeItsLayersMayBeLoaded) {
  work_and_move();
  ASSERT_TRUE(zone("mine", "door").ok);
  EXPECT_EQ(load("l1").code, "EXISTS");
  const Box box{{0, 0, 0}, {1, 1, 1}};
  ASSERT_TRUE(
      ask("in/zone", encode(ZoneRequest{"gone", "eva", ZoneRequest::Op::kDelete, "door", {}, box, {}, -1, 0})).ok);
  let_refusals_pass();
  const Answer may = load("l1");
  EXPECT_EQ(may.code, "BUSY");
  EXPECT_EQ(may.revision, loaded_incarnation(bytes_, "l1")) << "of this request and this file";
  ASSERT_TRUE(zone("mine2", "door").ok);
  EXPECT_EQ(load("l1").code, "EXISTS") << "looked at again when people have changed something";
}

TEST_F(NativeMapTest, AZoneThatIsGoneInTheFileMayHaveTheNameOfOneHere) {
  send_wall();
  const Box box{{0, 0, 0}, {1, 1, 1}};
  ASSERT_TRUE(zone("z1", "door").ok);
  ASSERT_TRUE(
      ask("in/zone", encode(ZoneRequest{"z2", "eva", ZoneRequest::Op::kDelete, "door", {}, box, {}, -1, 0})).ok);
  ASSERT_TRUE(zone("z3", "lift").ok);
  run();
  ASSERT_TRUE(ask_map("s1", MapRequest::Op::kSave).ok);
  bytes_ = *read_whole_file(file(), 100'000);
  move();
  ASSERT_TRUE(zone("mine", "door").ok);
  load_layers("l1");
  const Answer loaded = load("l1");
  ASSERT_TRUE(loaded.ok) << loaded.message;
  run();
  ASSERT_EQ(zones_->items().size(), 2u);
  EXPECT_EQ(zones_->items()[0].name, "door");
  EXPECT_EQ(zones_->items()[1].name, "lift");
}

TEST_F(NativeMapTest, AnUndoThatIsSoAlreadyIsNothingLeftToDo) {
  send_wall();
  const Bytes edit_message = encode(edit_of("e1", "eva", {3, 0, 0}));
  ASSERT_TRUE(ask("in/edit", edit_message).ok);
  ASSERT_TRUE(undo("u1", "e1").ok);
  run();
  ASSERT_TRUE(ask_map("s1", MapRequest::Op::kSave).ok);
  bytes_ = *read_whole_file(file(), 100'000);
  move();
  ASSERT_TRUE(ask("in/edit", edit_message).ok) << "the same edit, undone by another request";
  ASSERT_TRUE(undo("mine", "e1").ok);
  load_layers("l1");
  const Answer loaded = load("l1");
  ASSERT_TRUE(loaded.ok) << loaded.message;
  EXPECT_EQ(history().size(), 2u);
}

TEST_F(NativeMapTest, ACorruptOrForeignFileChangesNothing) {
  work_and_move();
  load_layers("l1");
  Bytes damaged = bytes_;
  damaged[damaged.size() / 2] ^= 1;
  ASSERT_TRUE(write_whole_file(file(), damaged));
  EXPECT_EQ(load("l1").code, "MALFORMED");
  ASSERT_TRUE(write_whole_file(file(), Bytes(500, 7)));
  let_refusals_pass();
  EXPECT_EQ(load("l1").code, "MALFORMED");
  std::filesystem::remove(file());
  let_refusals_pass();
  EXPECT_EQ(load("l1").code, "NOT_FOUND");
  EXPECT_TRUE(history().empty());
  EXPECT_TRUE(node_->map().empty());
}

TEST_F(NativeMapTest, IsOverwrittenOnlyWhenAsked) {
  run(5'000'000);
  ASSERT_TRUE(ask_map("s1", MapRequest::Op::kSave).ok);
  EXPECT_EQ(ask_map("s2", MapRequest::Op::kSave).code, "EXISTS");
  EXPECT_TRUE(ask_map("s3", MapRequest::Op::kSave, true).ok);
}

TEST_F(NativeMapTest, OtherFormatsAreIngestsToLoad) {
  answers_.clear();
  const MapRequest other{"l1", MapRequest::Op::kLoad, "hall", {"bt"}, false, ""};
  EXPECT_TRUE(ask("in/map_request", encode(other, bus_->now())).id.empty());
}

TEST_F(NativeMapTest, IsNotSavedWithoutLabelsWhileSemanticIsMerelyBusy) {
  start();
  send_wall();
  ASSERT_TRUE(place("t1", somewhere()).ok);
  const auto semantic_speaks = [&] {
    bus_->publish("out/status/semantic", encode(ProcessStatus{bus_->now(), "semantic", 1, {}}));
    bus_->deliver();
  };
  semantic_speaks();
  bus_->advance_to(bus_->now() + 20'000'000);
  const Answer busy = ask_map("s1", MapRequest::Op::kSave);
  EXPECT_EQ(busy.code, "BUSY");
  EXPECT_NE(busy.message.find("20 s"), std::string::npos) << busy.message;
  semantic_speaks();
  bus_->advance_to(bus_->now() + 60'000'000);
  EXPECT_EQ(ask_map("s2", MapRequest::Op::kSave).code, "BUSY");
  bus_->advance_to(bus_->now() + 31'000'000);
  const Answer saved = ask_map("s3", MapRequest::Op::kSave);
  EXPECT_TRUE(saved.ok);
  EXPECT_NE(saved.message.find("without labels"), std::string::npos) << saved.message;
}

TEST_F(NativeMapTest, IsNotSavedWithoutLabelsThatAreKeptThoughSemanticWasNotHeardSinceTheStart) {
  start();
  send_wall();
  ASSERT_TRUE(place("t1", somewhere()).ok);
  ASSERT_TRUE(write_whole_file(site_.state / "semantic.db", Bytes{1}));
  bus_->advance_to(bus_->now() + 10'000'000);
  EXPECT_EQ(ask_map("s1", MapRequest::Op::kSave).code, "BUSY");
  bus_->advance_to(bus_->now() + 90'000'000);
  EXPECT_TRUE(ask_map("s2", MapRequest::Op::kSave).ok);
}

}  // namespace
}  // namespace concord
