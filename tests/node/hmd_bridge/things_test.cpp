// Assets, put into the map, moved, taken out; what is seen of them, confirmed or rejected.

#include <filesystem>
#include <fstream>

#include "bridge_test.hpp"

namespace concord::hmd {
namespace {

/// A hall, and a crate of 1 x 0.6 x 0.4 m among the assets.
class Furnishing : public Working {
 protected:
  void SetUp() override {
    Working::SetUp();
    const auto folder = lab.site.state / "assets";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "assets.yaml") << "crate: {file: crate.obj, class: box}\n";
    std::ofstream out(folder / "crate.obj");
    for (int i = 0; i < 8; ++i) {
      out << "v " << (i & 1) * 1.0 << " " << (i >> 1 & 1) * 0.6 << " " << (i >> 2) * 0.4 << "\n";
    }
    out << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    out.close();
    lab.run(4);
  }
  static Pose at(double x, double y = 3) { return {{x, y, 0.02}, {0, 0, 0, 1}}; }
  /// Whether its voxels are there.
  [[nodiscard]] bool is_there(double x, double y = 3) const {
    return is_occupied(lab.merge->map().at(voxel_of(Eigen::Vector3d(x + 0.5, y + 0.3, 0.25), lab.site.resolution)));
  }
  Json put(double x) {
    Json answer = ana.ask(AssetAddRequest{"crate", Frame::kMap, at(x)});
    EXPECT_CODE(answer, "OK");
    lab.run(2);
    return answer["answer"];
  }
  Json see(double x, double score = 0.9) { return ana.ask(DetectionRequest{"box", Frame::kMap, at(x), score}); }
  Json instances() { return ana.ask(InstancesRequest{{}, 1000})["answer"]["instances"]; }
};

TEST_F(Furnishing, AssetsAreListedWithTheirSizeAndWhereTheirModelIs) {
  const Json answer = ana.ask(AssetsRequest{});
  ASSERT_TRUE(has_code(answer, "OK"));
  const Json assets = answer["answer"]["assets"];
  ASSERT_EQ(assets.size(), 1U);
  EXPECT_EQ(assets[0]["asset"], "crate");
  EXPECT_EQ(assets[0]["class_name"], "box");
  EXPECT_NEAR(assets[0]["size"][1].get<double>(), 0.6, 1e-6);
  EXPECT_EQ(assets[0]["gltf"], "/models/crate.glb");
}

TEST_F(Furnishing, AnAssetIsPutMovedAndTakenOut) {
  const Json made = put(1);
  EXPECT_EQ(made["label"], 1);
  EXPECT_EQ(made["instance"], 1);
  EXPECT_GE(made["voxels"], 10 * 6 * 4);
  EXPECT_TRUE(is_there(1));
  ASSERT_EQ(instances().size(), 1U);
  EXPECT_EQ(instances()[0]["asset"], "crate");
  EXPECT_EQ(instances()[0]["class_name"], "box");
  EXPECT_NEAR(instances()[0]["T_map_asset"]["position"][0].get<double>(), 1.0, 1e-6);
  Pose turned = at(4);
  turned.rotation = {0, 0, 1, 0};
  turned.position[0] += 1.0, turned.position[1] += 0.6;  // its corner, so that it covers the same place
  const Json moved = ana.ask(AssetMoveRequest{1, 1, Frame::kMap, turned});
  ASSERT_TRUE(has_code(moved, "OK"));
  lab.run(2);
  const Json lies = instances()[0]["T_map_asset"];
  EXPECT_NEAR(lies["position"][0].get<double>(), 5.0, 1e-6);
  EXPECT_NEAR(std::abs(lies["rotation"][2].get<double>()), 1.0, 1e-6) << "whoever moves it again keeps its turn";
  EXPECT_FALSE(is_there(1));
  EXPECT_TRUE(is_there(4));
  EXPECT_CODE(ana.ask(UndoRequest{moved["answer"]["undo"]}), "OK");
  lab.run(2);
  EXPECT_TRUE(is_there(1));
  EXPECT_FALSE(is_there(4));
  EXPECT_CODE(ana.ask(AssetDeleteRequest{1, 1}), "OK");
  lab.run(2);
  EXPECT_FALSE(is_there(1));
  EXPECT_TRUE(instances().empty());
}

TEST_F(Furnishing, AnInjectionIsUndone) {
  const std::string undo = put(1)["undo"];
  EXPECT_CODE(ana.ask(UndoRequest{undo}), "OK");
  lab.run(2);
  EXPECT_FALSE(is_there(1));
  EXPECT_CODE(ana.ask(RedoRequest{undo}), "OK");
  lab.run(2);
  EXPECT_TRUE(is_there(1));
}

TEST_F(Furnishing, AssetsAreRefusedForTheirReasons) {
  EXPECT_CODE(ana.ask(AssetAddRequest{"sofa", Frame::kMap, at(1)}), "NO_ASSET");
  EXPECT_CODE(ana.ask(AssetAddRequest{"crate", Frame::kMap, at(9000)}), "OUT_OF_BOUNDS");
  EXPECT_CODE(ana.ask(AssetAddRequest{"crate", Frame::kMap, {{0, 0, 0}, {0, 0, 0, 0}}}), "BAD_REQUEST");
  EXPECT_CODE(ana.ask(AssetAddRequest{"crate", Frame::kOwn, at(1)}), "BAD_FRAME") << "ana is no agent";
  EXPECT_CODE(ana.ask(AssetMoveRequest{1, 1, Frame::kMap, at(1)}), "NO_INSTANCE");
  EXPECT_CODE(ana.ask(AssetMoveRequest{0, 0, Frame::kMap, at(1)}), "NO_INSTANCE");
  EXPECT_CODE(ana.ask(AssetDeleteRequest{1, 1}), "NO_INSTANCE");
  put(1);
  EXPECT_CODE(ana.ask(AssetMoveRequest{1, 1, Frame::kMap, at(9000)}), "OUT_OF_BOUNDS");
  Client bert(lab);
  HelloRequest hello;
  hello.version = kProtocol;
  hello.name = "bert";
  EXPECT_CODE(bert.ask(hello), "OK");
  EXPECT_CODE(bert.ask(LeaseHoldRequest{"mine", Frame::kMap, Box{{0, 0, 0}, {6, 6, 1}}}), "OK");
  EXPECT_CODE(ana.ask(AssetAddRequest{"crate", Frame::kMap, at(4)}), "LOCKED");
  EXPECT_CODE(ana.ask(AssetMoveRequest{1, 1, Frame::kMap, at(4)}), "LOCKED");
  EXPECT_CODE(ana.ask(AssetDeleteRequest{1, 1}), "LOCKED");
  lab.run(2);
  EXPECT_TRUE(is_there(1));
  EXPECT_FALSE(is_there(4));
}

TEST_F(Furnishing, WhatIsSeenIsProposedToEverybodyAndConfirmed) {
  Client bert(lab);
  EXPECT_CODE(bert.hello(), "OK");
  EXPECT_CODE(ana.ask(add(box(2, 3, 0, 3, 3.6, 0.4))), "OK");  // it has been scanned: what is seen is fitted to that
  lab.run(1);
  const Json seen = see(2);
  ASSERT_TRUE(has_code(seen, "OK"));
  const std::string detection = seen["answer"]["detection"];
  lab.run(1);
  bert.read();
  EXPECT_EQ(bert.events["detection"]["detection"], detection);
  EXPECT_EQ(bert.events["detection"]["class_name"], "box");
  EXPECT_EQ(bert.events["detection"]["by"], "ana");
  EXPECT_TRUE(bert.events["detection"]["open"].get<bool>());
  EXPECT_TRUE(instances().empty()) << "nobody has said so";
  Client later(lab);
  EXPECT_CODE(later.hello(), "OK");
  EXPECT_EQ(later.events["detection"]["detection"], detection) << "who comes later is told too";

  const Json confirmed = bert.ask(DetectionConfirmRequest{detection});
  ASSERT_TRUE(has_code(confirmed, "OK"));
  EXPECT_EQ(confirmed["answer"]["instance"], 1);
  EXPECT_NE(confirmed["answer"]["message"].get<std::string>().find("of its surface"), std::string::npos);
  lab.run(2);
  ASSERT_EQ(instances().size(), 1U);
  EXPECT_EQ(instances()[0]["asset"], "crate");
  EXPECT_NEAR(instances()[0]["min"][0].get<double>(), 2, 0.11);
  ana.read();
  EXPECT_FALSE(ana.events["detection"]["open"].get<bool>());
  EXPECT_CODE(ana.ask(DetectionConfirmRequest{detection}), "EXPIRED");
  EXPECT_CODE(ana.ask(UndoRequest{confirmed["answer"]["undo"]}), "OK");
  lab.run(2);
  EXPECT_TRUE(instances().empty());
  Client last(lab);
  EXPECT_CODE(last.hello(), "OK");
  EXPECT_FALSE(last.events.contains("detection")) << "it is decided";
}

TEST_F(Furnishing, WhatIsSeenIsRejected) {
  const std::string detection = see(2)["answer"]["detection"];
  EXPECT_CODE(ana.ask(DetectionRejectRequest{detection}), "OK");
  lab.run(1);
  ana.read();
  EXPECT_FALSE(ana.events["detection"]["open"].get<bool>());
  EXPECT_CODE(ana.ask(DetectionRejectRequest{detection}), "EXPIRED");
  EXPECT_CODE(ana.ask(DetectionConfirmRequest{detection}), "EXPIRED");
  EXPECT_CODE(ana.ask(DetectionConfirmRequest{"none"}), "EXPIRED");
  EXPECT_CODE(ana.ask(DetectionRejectRequest{"-1"}), "EXPIRED");
  EXPECT_FALSE(is_there(2));
}

TEST_F(Furnishing, DetectionsAreRefusedForTheirReasons) {
  EXPECT_CODE(see(2, 0.3), "LOW_SCORE");
  EXPECT_CODE(see(2, 1.5), "BAD_REQUEST");
  EXPECT_CODE(see(9000), "OUT_OF_BOUNDS");
  EXPECT_CODE(ana.ask(DetectionRequest{"sofa", Frame::kMap, at(2), 0.9}), "NO_ASSET");
  EXPECT_CODE(ana.ask(DetectionRequest{"a/b", Frame::kMap, at(2), 0.9}), "BAD_NAME");
  EXPECT_CODE(ana.ask(DetectionRequest{"box", Frame::kOwn, at(2), 0.9}), "BAD_FRAME");
  Client bert(lab);
  become_agent(bert, "quest", false);
  EXPECT_CODE(bert.ask(DetectionRequest{"box", Frame::kOwn, at(2), 0.9}), "UNALIGNED");
  bert.note(TrackingNotice{Tracking::kLost, {}, {}, {}});
  EXPECT_CODE(bert.ask(DetectionRequest{"box", Frame::kOwn, at(2), 0.9}), "TRACKING_LOST");
}

TEST_F(Furnishing, AModelThatIsGoneIsNotConfirmed) {
  const std::string detection = see(2)["answer"]["detection"];
  lab.run(1);
  std::filesystem::remove(lab.site.state / "assets" / "assets.yaml");
  lab.run(2);
  EXPECT_CODE(ana.ask(DetectionConfirmRequest{detection}), "NO_ASSET");
}

}  // namespace
}  // namespace concord::hmd
