#include <fstream>

#include "bus/messages_detection.hpp"
#include "semantic_station.hpp"

namespace concord {
namespace {

/// A crate of 1 x 0.6 x 0.4 m among the assets.
class DetectionsNodeTest : public SemanticStation {
 protected:
  DetectionsNodeTest() {
    const auto folder = site_.state / "assets";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "assets.yaml") << "crate: {file: crate.obj, class: box}\nother: {file: crate.obj}\n";
    std::ofstream out(folder / "crate.obj");
    for (int i = 0; i < 8; ++i) {
      out << "v " << (i & 1) * 1.0 << " " << (i >> 1 & 1) * 0.6 << " " << (i >> 2) * 0.4 << "\n";
    }
    out << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    out.close();
    run();
  }

  static Transform at(double x) {
    Transform T = Transform::Identity();
    T.translation() = Eigen::Vector3d(x, 3, 0);
    return T;
  }
  Answer see(double x, double score = 0.9, const std::string& object = "", const std::string& asset = "crate") {
    const Detection detection{"v" + std::to_string(++asked_), "hmd", asset, object, score, at(x), {}, bus_->now()};
    return ask("in/detection", encode(detection));
  }
  Answer decide(const std::string& id, std::int64_t thing, DetectionDecision::Op op = DetectionDecision::Op::kConfirm) {
    return ask("in/detection_decision", encode(DetectionDecision{id, "eva", op, thing, bus_->now()}));
  }
  /// As everybody hears them.
  std::vector<Thing> things() {
    std::vector<Thing> out;
    ListReceiver<Thing> list(*bus_, counters_, "out/things", [&](const std::vector<Thing>& all) { out = all; });
    run();
    return out;
  }
  [[nodiscard]] bool is_there(double x) const {
    return is_occupied(merge_->map().at(voxel_of(Eigen::Vector3d(x + 0.55, 3.25, 0.25), site_.resolution)));
  }

  int asked_ = 0;
};

TEST_F(DetectionsNodeTest, IsProposedOnceAndInjectedWhenAPersonSaysSo) {
  EXPECT_EQ(see(2.0).message, "thing 1, a new one");
  EXPECT_EQ(see(2.1).message, "thing 1, seen before");
  auto all = things();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].class_name, "box");
  EXPECT_EQ(all[0].sightings, 2);
  EXPECT_FALSE(is_there(2.0));
  const Answer confirmed = decide("c1", 1);
  ASSERT_TRUE(confirmed.ok) << confirmed.message;
  EXPECT_NE(confirmed.message.find("of its surface within a voxel"), std::string::npos) << confirmed.message;
  run();
  EXPECT_TRUE(is_there(2.0));
  all = things();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].injection, "c1");
  EXPECT_TRUE(decide("c1", 1).ok);  // its answer was lost
  EXPECT_EQ(decide("c2", 1).code, "CONFLICT");
  EXPECT_EQ(see(2.0).message, "thing 1, seen before");
}

TEST_F(DetectionsNodeTest, WhatIsSeenElsewhereThriceIsMovedThereAndStaysItself) {
  see(2.0, 0.9, "target 7");
  ASSERT_TRUE(decide("c1", 1).ok);
  run();
  for (int i = 0; i < 3; ++i) see(6.0, 0.9, "target 7");
  run();
  EXPECT_FALSE(is_there(2.0));
  EXPECT_TRUE(is_there(6.0));
  const auto all = things();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_NEAR(all[0].T_map_asset.translation().x(), 6.0, 0.2);
}

TEST_F(DetectionsNodeTest, WhatWasInjectedIsKnownAfterARestartAndGoesWhenItIsTakenOut) {
  see(2.0);
  ASSERT_TRUE(decide("c1", 1).ok);
  see(9.0);
  start();
  run();
  auto all = things();
  ASSERT_EQ(all.size(), 1U);  // the one that nobody confirmed is seen again, or not
  EXPECT_EQ(all[0].injection, "c1");
  EXPECT_EQ(see(2.1).message, "thing 101, seen before") << "no number twice";
  ASSERT_TRUE(ask("in/undo", encode(UndoRequest{"u1", "eva", "asset-c1", false, bus_->now()})).ok);
  run();
  EXPECT_TRUE(things().empty());
}

TEST_F(DetectionsNodeTest, TwoWhoConfirmOneThingAtOnceInjectOne) {
  see(2.0);
  answers_.clear();
  for (const char* id : {"c1", "c2"}) {
    const DetectionDecision decision{id, id, DetectionDecision::Op::kConfirm, 1, bus_->now()};
    bus_->publish("in/detection_decision", encode(decision));
  }
  run();
  const auto answer_to = [&](const std::string& id) { return *std::ranges::find(answers_, id, &Answer::id); };
  EXPECT_TRUE(answer_to("c1").ok) << answer_to("c1").message;
  EXPECT_EQ(answer_to("c2").code, "CONFLICT");
  EXPECT_EQ(things().size(), 1U);
}

TEST_F(DetectionsNodeTest, AfterARefusalItMayBeConfirmedAgain) {
  std::filesystem::rename(site_.state / "assets/crate.obj", site_.state / "assets/away.obj");
  see(2.0);
  EXPECT_EQ(decide("c1", 1).code, "NOT_FOUND");
  std::filesystem::rename(site_.state / "assets/away.obj", site_.state / "assets/crate.obj");
  run();
  EXPECT_TRUE(decide("c2", 1).ok);
}

TEST_F(DetectionsNodeTest, DecisionsAskedAgainAreAnsweredAlikeAfterARestartToo) {
  see(2.0);
  see(9.0);
  const DetectionDecision drop{"d1", "eva", DetectionDecision::Op::kDrop, 2, bus_->now()};
  ASSERT_TRUE(ask("in/detection_decision", encode(drop)).ok);
  EXPECT_TRUE(ask("in/detection_decision", encode(drop)).ok);
  const DetectionDecision confirm{"c1", "eva", DetectionDecision::Op::kConfirm, 1, bus_->now()};
  ASSERT_TRUE(ask("in/detection_decision", encode(confirm)).ok);
  start();
  see(12.0);  // another thing; it must not be what the old number means
  const Answer again = ask("in/detection_decision", encode(confirm));
  EXPECT_TRUE(again.ok) << again.message;
  EXPECT_EQ(things().size(), 2U);
  EXPECT_FALSE(is_there(12.0));
  DetectionDecision other = confirm;
  other.thing = 101;
  EXPECT_EQ(ask("in/detection_decision", encode(other)).code, "EXISTS");
}

TEST_F(DetectionsNodeTest, WhoSeesItOffDoesNotDragItOffItsSurface) {
  BrickMasks sides;
  for (int x = 0; x < 11; ++x) {
    for (int y = 0; y < 7; ++y) {
      for (int z = 0; z < 5; ++z) {
        if (x == 0 || x == 10 || y == 0 || y == 6 || z == 4) sides.insert({20 + x, 30 + y, z});
      }
    }
  }
  for (const auto& [index, mask] : sides.sorted()) agent_map_.set(index, Brick::uniform(mask, kOccupied));
  start();
  see(2.3);
  ASSERT_TRUE(decide("c1", 1).ok);
  run();
  const double there = things().at(0).T_map_asset.translation().x();
  EXPECT_NEAR(there, 2.0, 0.1);
  int edits = 0;
  bus_->subscribe("in/edit", [&edits](const std::string&, auto) { ++edits; });
  for (int i = 0; i < 40; ++i) see(i % 2 == 0 ? 2.3 : 1.65), run(1'000'000);
  for (int i = 0; i < 20; ++i) see(1.65), run(1'000'000);
  EXPECT_EQ(edits, 0);
  EXPECT_EQ(things().at(0).T_map_asset.translation().x(), there);
  start();
  for (int i = 0; i < 20; ++i) see(2.3), run(1'000'000);
  EXPECT_EQ(things().at(0).T_map_asset.translation().x(), there) << "after a restart";
}

TEST_F(DetectionsNodeTest, APersonsMoveStandsThoughSightingsCallForAnotherMeanwhile) {
  see(2.0, 0.9, "target 7");
  ASSERT_TRUE(decide("c1", 1).ok);
  run();
  // All in one tick: the person's move is being laid out when the sightings call for theirs.
  answers_.clear();
  const AssetRequest move{"m1", "eva", AssetRequest::Op::kMove, "", "c1", {}, at(9.0), bus_->now()};
  bus_->publish("in/asset", encode(move));
  for (int i = 0; i < 3; ++i) {
    const Detection seen{"w" + std::to_string(i), "hmd", "crate", "target 7", 0.9, at(6.0), {}, bus_->now()};
    bus_->publish("in/detection", encode(seen));
  }
  run(6'000'000);
  EXPECT_TRUE(is_there(9.0));
  EXPECT_FALSE(is_there(6.0));
}

TEST_F(DetectionsNodeTest, WhatAPersonDroppedIsNotProposedAgain) {
  see(2.0);
  ASSERT_TRUE(decide("d1", 1, DetectionDecision::Op::kDrop).ok);
  const Answer again = see(2.1);
  EXPECT_TRUE(again.ok);
  EXPECT_NE(again.message.find("dropped"), std::string::npos) << again.message;
  EXPECT_TRUE(things().empty());
  EXPECT_EQ(decide("c1", 1).code, "NOT_FOUND");
}

TEST_F(DetectionsNodeTest, WhatMayNotBeMovedIsNotTriedAgainAndAgain) {
  see(2.0, 0.9, "target 7");
  ASSERT_TRUE(decide("c1", 1).ok);
  run();
  LeaseRequest lease;
  lease.id = "lease";
  lease.author = "bob";
  lease.lease = "corner";
  lease.volume = Box{{5, 0, 0}, {9, 9, 2}};
  lease.utime = bus_->now();
  ASSERT_TRUE(ask("in/lease", encode(lease)).ok);
  int edits = 0;
  bus_->subscribe("in/edit", [&edits](const std::string&, auto) { ++edits; });
  for (int i = 0; i < 60; ++i) see(6.0, 0.9, "target 7");
  run(6'000'000);
  EXPECT_GE(edits, 1);
  EXPECT_LE(edits, 2);
}

TEST_F(DetectionsNodeTest, RefusesWhatIsUnsureUnknownOrNowhere) {
  EXPECT_EQ(see(2.0, 0.3).code, "LOW_SCORE");
  EXPECT_EQ(see(2.0, 0.9, "", "sofa").code, "NOT_FOUND");
  EXPECT_TRUE(see(2.0, 0.9, "", "box").ok);  // the one asset of that class
  EXPECT_EQ(see(2.0, std::nan("")).code, "BAD_REQUEST");
  EXPECT_EQ(decide("c1", 7).code, "NOT_FOUND");
  Detection astray{"w1", "hmd", "crate", "", 0.9, at(2.0), {"nobody", ""}, bus_->now()};
  EXPECT_EQ(ask("in/detection", encode(astray)).code, "NO_AGENT");
  ASSERT_TRUE(decide("d1", 1, DetectionDecision::Op::kDrop).ok);
  EXPECT_TRUE(things().empty());
}

}  // namespace
}  // namespace concord
