// Labels: said, shown, renamed, taken off, deleted, undone; one touch.

#include <algorithm>

#include "bridge_test.hpp"

namespace concord::hmd {
namespace {

const Shape kChair = box(1, 1, 0, 1.5, 1.5, 0.6);
constexpr std::int64_t kChairVoxels = 5 * 5 * 6;

/// A hall in which somebody has put two boxes onto the floor.
class Labelling : public Working {
 protected:
  void SetUp() override {
    Working::SetUp();
    EXPECT_CODE(ana.ask(add(kChair)), "OK");
    EXPECT_CODE(ana.ask(add(box(4, 4, 0, 4.5, 4.5, 0.6))), "OK");
    lab.run(1);
  }
  static LabelRequest label(const std::string& name, const Shape& shape = kChair) { return {Frame::kMap, shape, name}; }
  /// Labelled, and told to everybody.
  Json labelled(const std::string& name, const Shape& shape = kChair) {
    Json answer = ana.ask(label(name, shape));
    EXPECT_CODE(answer, "OK");
    lab.run(1);
    return answer["answer"];
  }
  Json instances() { return ana.ask(InstancesRequest{{}, 1000})["answer"]["instances"]; }
  [[nodiscard]] bool is_there(double x, double y, double z) const {
    return is_occupied(lab.merge->map().at(voxel_of(Eigen::Vector3d(x, y, z), lab.site.resolution)));
  }
};

TEST_F(Labelling, TheServerSaysWhichOneItIsAndAllAreListed) {
  const Json first = labelled("chair");
  EXPECT_EQ(first["voxels"], kChairVoxels);
  EXPECT_EQ(first["label"], 1);
  EXPECT_EQ(first["instance"], 1);
  EXPECT_EQ(labelled("chair", box(4, 4, 0, 4.5, 4.5, 0.6))["instance"], 2);
  const Json answer = ana.ask(LabelsRequest{})["answer"];
  EXPECT_EQ(answer["in_all"], 1);
  const Json& labels = answer["labels"];
  ASSERT_EQ(labels.size(), 1U);
  EXPECT_EQ(labels[0]["name"], "chair");
  EXPECT_EQ(labels[0]["instances"], 2);
  EXPECT_EQ(labels[0]["voxels"], 2 * kChairVoxels);
  const Json all = instances();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0]["class_name"], "chair");
  EXPECT_FALSE(all[0].contains("asset")) << "people said so";
  EXPECT_FALSE(all[0].contains("T_map_asset"));
  EXPECT_NEAR(all[0]["min"][0].get<double>(), 1.0, 1e-9);
  EXPECT_NEAR(all[0]["max"][2].get<double>(), 0.6, 1e-9);
  const Json one = ana.ask(InstancesRequest{1, 1});
  EXPECT_EQ(one["answer"]["instances"].size(), 1U);
  EXPECT_EQ(one["answer"]["in_all"], 2);
  EXPECT_CODE(ana.ask(InstancesRequest{7, 10}), "NO_LABEL");
  EXPECT_CODE(ana.ask(InstancesRequest{{}, 0}), "BAD_REQUEST");
}

TEST_F(Labelling, LabelsAreRefusedForTheirReasons) {
  EXPECT_CODE(ana.ask(label("a/b")), "BAD_NAME");
  EXPECT_CODE(ana.ask(label("")), "BAD_NAME");
  EXPECT_CODE(ana.ask(label("chair", box(3, 3, 0.2, 3.2, 3.2, 0.4))), "EMPTY");
  EXPECT_CODE(ana.ask(label("chair", box(2, 2, 2, 1, 1, 1))), "BAD_SHAPE");
  EXPECT_CODE(ana.ask(label("chair", box(9000, 0, 0, 9001, 1, 1))), "OUT_OF_BOUNDS");
  EXPECT_CODE(ana.ask(label("chair", Voxels{0.05, {{{0, 0, 0, 1, 1, 1}}}})), "RES_MISMATCH");
  LabelRequest own = label("chair");
  own.frame = Frame::kOwn;
  EXPECT_CODE(ana.ask(own), "BAD_FRAME") << "ana is no agent";
  Client bert(lab);
  become_agent(bert, "quest", false);
  EXPECT_CODE(bert.ask(own), "UNALIGNED");
  bert.note(TrackingNotice{Tracking::kLost, {}, {}, {}});
  EXPECT_CODE(bert.ask(own), "TRACKING_LOST");
  EXPECT_TRUE(instances().empty());
}

TEST_F(Labelling, OneTouchLabelsTheWholeThing) {
  EXPECT_CODE(ana.ask(add(box(0, 3, 0, 6.4, 3.2, 2.4))), "OK");  // a wall: what is lower is furniture
  lab.run(1);
  const Json touched = ana.ask(LabelTouchRequest{Frame::kMap, {1.2, 1.2, 0.5}, "chair"});
  ASSERT_TRUE(has_code(touched, "OK"));
  EXPECT_GE(touched["answer"]["voxels"], kChairVoxels * 2 / 3);
  EXPECT_LE(touched["answer"]["voxels"], kChairVoxels);
  EXPECT_NEAR(touched["answer"]["max"][2].get<double>(), 0.6, 0.11);
  EXPECT_CODE(ana.ask(UndoRequest{touched["answer"]["undo"]}), "OK");
  EXPECT_CODE(ana.ask(LabelTouchRequest{Frame::kMap, {3, 3, 2}, "chair"}), "EMPTY") << "nothing is near";
  EXPECT_CODE(ana.ask(LabelTouchRequest{Frame::kMap, {9000, 3, 2}, "chair"}), "OUT_OF_BOUNDS");
  EXPECT_CODE(ana.ask(LabelTouchRequest{Frame::kMap, {1.2, 1.2, 0.5}, "a/b"}), "BAD_NAME");
  EXPECT_CODE(ana.ask(LabelTouchRequest{Frame::kOwn, {1.2, 1.2, 0.5}, "chair"}), "BAD_FRAME");
}

TEST_F(Labelling, ALabelIsUndoneAndRedone) {
  const std::string undo = labelled("chair")["undo"];
  EXPECT_CODE(ana.ask(UndoRequest{undo}), "OK");
  EXPECT_TRUE(instances().empty());
  EXPECT_CODE(ana.ask(UndoRequest{undo}), "CONFLICT");
  EXPECT_CODE(ana.ask(RedoRequest{undo}), "OK");
  EXPECT_EQ(instances().size(), 1U);
  EXPECT_CODE(ana.ask(UndoRequest{"label/none"}), "NOT_FOUND");
  EXPECT_CODE(ana.ask(UndoRequest{"label/"}), "NOT_FOUND");
}

TEST_F(Labelling, AClassIsRenamedAndAThingReassigned) {
  labelled("chair");
  labelled("table", box(4, 4, 0, 4.5, 4.5, 0.6));
  const Json renamed = ana.ask(LabelRenameRequest{1, "stool"});
  ASSERT_TRUE(has_code(renamed, "OK"));
  EXPECT_EQ(instances()[0]["class_name"], "stool");
  EXPECT_CODE(ana.ask(LabelRenameRequest{1, "table"}), "EXISTS");
  EXPECT_CODE(ana.ask(LabelRenameRequest{9, "bench"}), "NO_LABEL");
  EXPECT_CODE(ana.ask(LabelRenameRequest{1, "a/b"}), "BAD_NAME");
  const Json moved = ana.ask(InstanceReassignRequest{1, 1, "table"});
  ASSERT_TRUE(has_code(moved, "OK"));
  EXPECT_EQ(moved["answer"]["label"], 2);
  EXPECT_EQ(moved["answer"]["instance"], 2);
  EXPECT_EQ(moved["answer"]["voxels"], kChairVoxels);
  lab.run(1);
  EXPECT_CODE(ana.ask(InstanceReassignRequest{1, 7, "table"}), "NO_INSTANCE");
  EXPECT_CODE(ana.ask(InstanceReassignRequest{9, 1, "table"}), "NO_LABEL");
  EXPECT_CODE(ana.ask(InstanceReassignRequest{2, 2, "a/b"}), "BAD_NAME");
  EXPECT_CODE(ana.ask(UndoRequest{moved["answer"]["undo"]}), "OK");
  EXPECT_CODE(ana.ask(UndoRequest{renamed["answer"]["undo"]}), "OK");
  EXPECT_EQ(instances()[0]["class_name"], "chair");
}

TEST_F(Labelling, AThingGoesWithItsVoxelsOrItsLabelAlone) {
  labelled("chair");
  const Json off = ana.ask(InstanceDeleteRequest{1, 1, true});
  ASSERT_TRUE(has_code(off, "OK"));
  EXPECT_EQ(off["answer"]["voxels"], kChairVoxels);
  lab.run(1);
  EXPECT_TRUE(instances().empty());
  EXPECT_TRUE(is_there(1.2, 1.2, 0.3));
  EXPECT_CODE(ana.ask(UndoRequest{off["answer"]["undo"]}), "OK");
  lab.run(1);
  const Json gone = ana.ask(InstanceDeleteRequest{1, 1, false});
  ASSERT_TRUE(has_code(gone, "OK"));
  EXPECT_EQ(gone["answer"]["voxels"], kChairVoxels);
  lab.run(1);
  EXPECT_FALSE(is_there(1.2, 1.2, 0.3));
  EXPECT_CODE(ana.ask(InstanceDeleteRequest{1, 1, false}), "NO_INSTANCE");
  EXPECT_CODE(ana.ask(InstanceDeleteRequest{1, 9, false}), "NO_INSTANCE");
  EXPECT_CODE(ana.ask(InstanceDeleteRequest{9, 1, false}), "NO_LABEL");
  EXPECT_CODE(ana.ask(UndoRequest{gone["answer"]["undo"]}), "OK");
  lab.run(1);
  EXPECT_EQ(instances().size(), 1U) << "voxels and label are back";
}

TEST_F(Labelling, AClassGoesWithAllItsThings) {
  labelled("chair");
  labelled("chair", box(4, 4, 0, 4.5, 4.5, 0.6));
  EXPECT_CODE(ana.ask(LabelDeleteRequest{9, true}), "NO_LABEL");
  const Json off = ana.ask(LabelDeleteRequest{1, true});
  ASSERT_TRUE(has_code(off, "OK"));
  EXPECT_EQ(off["answer"]["voxels"], 2 * kChairVoxels);
  lab.run(1);
  EXPECT_CODE(ana.ask(LabelDeleteRequest{1, false}), "EMPTY") << "nothing shows it now";
  EXPECT_CODE(ana.ask(UndoRequest{off["answer"]["undo"]}), "OK");
  lab.run(1);
  EXPECT_CODE(ana.ask(LabelDeleteRequest{1, false}), "OK");
  lab.run(1);
  EXPECT_FALSE(is_there(4.2, 4.2, 0.3));
}

TEST_F(Labelling, WhatSomebodyElseWorksOnIsNotDeleted) {
  labelled("chair");
  Client bert(lab);
  HelloRequest hello;
  hello.version = kProtocol;
  hello.name = "bert";
  EXPECT_CODE(bert.ask(hello), "OK");
  EXPECT_CODE(bert.ask(LeaseHoldRequest{"mine", Frame::kMap, Box{{0, 0, 0}, {2, 2, 1}}}), "OK");
  EXPECT_CODE(ana.ask(InstanceDeleteRequest{1, 1, false}), "LOCKED");
  EXPECT_CODE(ana.ask(LabelDeleteRequest{1, false}), "LOCKED");
  EXPECT_TRUE(is_there(1.2, 1.2, 0.3));
}

/// What the frames of the label layer say in all.
std::map<std::pair<std::uint32_t, std::uint32_t>, std::int64_t> shown(const Client& client) {
  std::map<BlockIndex, LabelContent> blocks;
  for (const BinaryFrame& frame : client.frames) {
    if (frame.head.kind != FrameKind::kLabels) continue;
    LabelContent content = read_labels(frame).value();
    blocks.insert_or_assign(content.block, std::move(content));
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::int64_t> all;
  for (const auto& [index, content] : blocks) {
    for (const auto& run : content.runs) {
      const auto& thing = content.things.at(run.thing);
      all[{thing.label, thing.instance}] += run.length;
    }
  }
  return all;
}

/// What the latest frame of the block at the origin says of a voxel in it.
std::pair<std::uint32_t, std::uint32_t> thing_at(const Client& client, std::uint32_t x, std::uint32_t y,
                                                 std::uint32_t z) {
  LabelContent latest;
  for (const BinaryFrame& frame : client.frames) {
    if (frame.head.kind != FrameKind::kLabels) continue;
    if (LabelContent content = read_labels(frame).value(); content.block == BlockIndex{0, 0, 0}) latest = content;
  }
  std::uint32_t at = 0;
  for (const auto& run : latest.runs) {
    at += run.gap + run.length;
    const std::uint32_t voxel = x + 64 * y + 4096 * z;
    const auto& thing = latest.things.at(run.thing);
    if (voxel < at) return voxel + run.length >= at ? std::pair(thing.label, thing.instance) : std::pair(0U, 0U);
  }
  return {};
}

TEST_F(Labelling, ASemanticThatWasStartedAnewMayGiveTheSameSlotsToOtherThings) {
  const ListReceiver<LabelSlot> slots(*lab.bus, lab.counters, "out/label_slots", [](const auto&) {});
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kLabels, {}, Frame::kMap, {3, 3, 0}, {20}, {}}), "OK");
  labelled("table", box(4, 4, 0, 4.5, 4.5, 0.6));
  labelled("chair");
  using Thing = std::pair<std::uint32_t, std::uint32_t>;
  const Thing table{1, 1}, chair{2, 1};
  const std::vector<LabelSlot> before = slots.items();
  ana.read();
  EXPECT_EQ(thing_at(ana, 42, 42, 3), table);
  EXPECT_EQ(thing_at(ana, 12, 12, 3), chair);
  lab.restart_semantic();
  lab.run(5);
  ASSERT_EQ(slots.items().size(), before.size());
  ASSERT_NE(slots.items(), before) << "slots are numbered as bricks come";
  ana.read();
  EXPECT_EQ(thing_at(ana, 42, 42, 3), table);
  EXPECT_EQ(thing_at(ana, 12, 12, 3), chair);
}

TEST_F(Labelling, TheViewSaysWhichVoxelIsWhat) {
  using All = std::map<std::pair<std::uint32_t, std::uint32_t>, std::int64_t>;
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kLabels, {}, Frame::kMap, {3, 3, 0}, {20}, {}}), "OK");
  labelled("chair");
  labelled("table", box(4, 4, 0, 4.5, 4.5, 0.6));
  ana.read();
  EXPECT_EQ(shown(ana), (All{{{1, 1}, kChairVoxels}, {{2, 1}, kChairVoxels}}));
  // The same voxels, another thing.
  EXPECT_CODE(ana.ask(InstanceReassignRequest{1, 1, "table"}), "OK");
  lab.run(1);
  ana.read();
  EXPECT_EQ(shown(ana), (All{{{2, 1}, kChairVoxels}, {{2, 2}, kChairVoxels}}));
  EXPECT_CODE(ana.ask(LabelDeleteRequest{2, true}), "OK");
  lab.run(1);
  ana.read();
  EXPECT_EQ(shown(ana), All{});
  // Who comes later sees what is there.
  labelled("lamp");
  Client bert(lab);
  EXPECT_CODE(bert.hello(), "OK");
  EXPECT_CODE(bert.ask(ViewRequest{Layer::kLabels, {}, Frame::kMap, {3, 3, 0}, {20}, {}}), "OK");
  lab.run(1);
  bert.read();
  EXPECT_EQ(shown(bert), (All{{{3, 1}, kChairVoxels}}));
}

TEST(BridgeWithoutSemantic, SaysSo) {
  Lab lab(Lab::kWithoutSemantic);
  Client ana(lab);
  EXPECT_CODE(ana.hello(), "OK");
  EXPECT_CODE(ana.ask(AssetsRequest{}), "UNAVAILABLE");
  EXPECT_CODE(ana.ask(LabelsRequest{}), "UNAVAILABLE");
  EXPECT_CODE(ana.ask(InstancesRequest{{}, 10}), "UNAVAILABLE");
  EXPECT_CODE(ana.ask(LabelRequest{Frame::kMap, kChair, "chair"}), "UNAVAILABLE");
  EXPECT_CODE(ana.ask(DetectionRejectRequest{"1"}), "UNAVAILABLE");
  EXPECT_CODE(ana.ask(ViewRequest{Layer::kLabels, {}, Frame::kMap, {3, 3, 0}, {20}, {}}), "UNAVAILABLE");
}

}  // namespace
}  // namespace concord::hmd
