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
  EXPECT_EQ(see(2.1).message, "thing 1, seen before");
  ASSERT_TRUE(ask("in/undo", encode(UndoRequest{"u1", "eva", "asset-c1", false, bus_->now()})).ok);
  run();
  EXPECT_TRUE(things().empty());
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
