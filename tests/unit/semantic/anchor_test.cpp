#include "semantic/labels/anchor.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/compose.hpp"
#include "semantic/labels/label_view.hpp"

namespace concord {
namespace {

constexpr double kResolution = 0.1;

Transform turned(double x, double y, double degrees) {
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(degrees * M_PI / 180, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(x, y, 0.03);
  return T;
}

/// A plate of 20 x 12 x 2 voxels and a post beside it, in an agent's own lattice.
BrickMap plate_and_post() {
  BrickMasks out;
  for (std::int32_t x = 0; x < 20; ++x) {
    for (std::int32_t y = 0; y < 12; ++y) out.insert_column(x, y, 10, 11);
  }
  out.insert_column(40, 5, 0, 15);
  return out.to_map(kOccupied);
}

std::vector<VoxelIndex> occupied_below(const BrickMap& map, const Transform& T, std::int32_t x_end) {
  std::vector<VoxelIndex> out;
  for (const VoxelIndex v : occupied_of(map).voxels()) {
    if ((T.inverse() * centre_of(v, kResolution)).x() < x_end * kResolution) out.push_back(v);
  }
  return out;
}

BrickMap map_at(const BrickMap& layer, const Transform& T) {
  const Layer placed{&layer, T, 1};
  return compose({&placed, 1}, PinMap(), Policy::kMean, kResolution).values;
}

TEST(Anchor, WhatMovesWithItsAgentIsAllOfItAndNothingElse) {
  const BrickMap agent = plate_and_post();
  const Transform then = turned(1.03, -0.4, 17), now = turned(-2.21, 3.3, 64);
  const auto claimed = occupied_below(map_at(agent, then), then, 30);
  ASSERT_GT(claimed.size(), 400U);
  const BrickMasks moved = followed(masks_of(claimed).sorted(), then, now, kResolution);
  const BrickMap map = map_at(agent, now);
  for (const VoxelIndex v : occupied_of(map).voxels()) {
    const bool is_plate = (now.inverse() * centre_of(v, kResolution)).x() < 3.0;
    EXPECT_EQ(moved.contains(v), is_plate) << v.x << " " << v.y << " " << v.z;
  }
}

TEST(Anchor, WhereItLaysAsItDidItIsWhatWasClaimed) {
  const Transform then = turned(1.03, -0.4, 17);
  const auto claimed = masks_of(occupied_below(map_at(plate_and_post(), then), then, 7)).sorted();
  EXPECT_EQ(followed(claimed, then, then, kResolution).sorted(), claimed);
}

TEST(Anchor, BelongsToTheAgentThatHasMostOfIt) {
  const BrickMap agent = plate_and_post();
  BrickMap other;
  other.set({0, 0, 1}, *agent.find(BrickIndex{0, 0, 1}));
  AgentLayers layers;
  layers["a"] = {"frame-a", other, 1, true, 1, Transform::Identity()};
  layers["b"] = {"frame-b", agent, 1, true, 1, Transform::Identity()};
  layers["c"] = {"frame-c", agent, 1, true, 1, std::nullopt};  // is nowhere
  layers["d"] = {"frame-d", agent, 1, true, 1, Transform::Identity()};
  const auto all = occupied_of(agent).voxels();
  EXPECT_EQ(anchor_of(all, layers, kResolution).agent, "b");
  EXPECT_EQ(anchor_of(all, layers, kResolution).frame_id, "frame-b");
  EXPECT_EQ(anchor_of({{1, 1, 10}}, layers, kResolution).agent, "a");
  EXPECT_EQ(anchor_of({{1, 1, 10}, {500, 0, 0}, {501, 0, 0}}, layers, kResolution).agent, "");  // a minority
}

void place(Labels& labels, const Transform& T_map_agent, BrickSet& touched) {
  labels.place({"robot", "f", T_map_agent});
  while (labels.lay_some(1, touched)) {
  }
}

TEST(Labels, GoAlongWithTheAgentBackAndForthAndLeaveNothingBehind) {
  const BrickMap agent = plate_and_post();
  const Transform then = turned(1.03, -0.4, 17), now = turned(-2.21, 3.3, 64);
  Labels labels(kResolution);
  BrickSet touched;
  LabelCorrection::Claim claim{
      {1, 1}, "plate", occupied_below(map_at(agent, then), then, 30), "", {"robot", "f", then}};
  labels.apply({1, "l1", "eva", 0, 1, claim}, touched);
  labels.apply({2, "l2", "eva", 0, 1, LabelCorrection::Claim{{1, 2}, "", {claim.voxels[0]}, "", {}}}, touched);
  EXPECT_FALSE(labels.is_news({"robot", "other", now}));
  ASSERT_TRUE(labels.is_news({"robot", "f", now}));
  touched.clear();
  place(labels, now, touched);
  EXPECT_FALSE(labels.is_news({"robot", "f", now}));
  Transform said_again = now;
  said_again.translation().x() += 1e-12;
  EXPECT_FALSE(labels.is_news({"robot", "f", said_again}));
  EXPECT_TRUE(touched.contains(brick_of(claim.voxels.back())));
  EXPECT_EQ(labels.at(claim.voxels[0]), (InstanceId{1, 2}));  // lies on the map
  EXPECT_EQ(labels.at(claim.voxels.back()), std::nullopt);
  const BrickMap map = map_at(agent, now);
  LabelView view(labels, map, kResolution);
  for (const BrickIndex index : labels.sorted_bricks()) view.refresh(index);
  EXPECT_GT(view.instance({1, 1}).voxels, 400);
  place(labels, then, touched);
  for (const VoxelIndex v : claim.voxels) EXPECT_TRUE(labels.at(v).has_value());
  // One that is claimed where it lies now, and undone while it lies elsewhere.
  LabelRequest undo;
  undo.op = LabelRequest::Op::kUndo;
  undo.correction_id = "l1";
  labels.apply({3, "u1", "eva", 0, 1, *labels.check(undo, {})}, touched);
  place(labels, now, touched);
  undo.op = LabelRequest::Op::kRedo;
  labels.apply({4, "u2", "eva", 0, 1, *labels.check(undo, {})}, touched);
  place(labels, then, touched);
  EXPECT_EQ(labels.at(claim.voxels.back()), (InstanceId{1, 1}));
}

Labels::What asked(const Labels& labels, LabelRequest::Op op, const std::string& id) {
  LabelRequest request;
  request.op = op;
  request.correction_id = id;
  return *labels.check(request, {});
}

/// Laid a few at a time while they are moved, undone and redone, labels come to lie as if all was laid at once.
RC_GTEST_PROP(Labels, LieAlikeHoweverManyAreLaidAtOnce, ()) {
  constexpr int kClaims = 6;
  Labels a_few(kResolution), at_once(kResolution);
  BrickSet touched, ignored;
  std::vector<bool> active(kClaims, true);
  std::int64_t revision = 0;
  const auto apply = [&](const std::string& id, const Labels::What& what) {
    ++revision;
    a_few.apply({revision, id, "eva", 0, 1, what}, touched);
    at_once.apply({revision, id, "eva", 0, 1, what}, ignored);
  };
  for (int i = 0; i < kClaims; ++i) {
    const Transform T = turned(0.1 * i, 0.3, 10 * i);
    LabelCorrection::Claim claim{
        {1, static_cast<std::uint32_t>(i + 1)}, i == 0 ? "thing" : "", {}, "", {"robot", "f", T}};
    for (int x = 0; x < 20; ++x) claim.voxels.push_back({x, 3 * i, 0});
    std::ranges::sort(claim.voxels);
    apply("l" + std::to_string(i), claim);
  }
  const int steps = *rc::gen::inRange(1, 30);
  for (int step = 0; step < steps; ++step) {
    const int what = *rc::gen::inRange(0, 3), which = *rc::gen::inRange(0, kClaims);
    if (what == 0) {
      const Transform T = turned(*rc::gen::inRange(-30, 30) * 0.07, 0.2, *rc::gen::inRange(0, 360));
      a_few.place({"robot", "f", T});
      place(at_once, T, ignored);
    } else if (what == 1) {
      (void)a_few.lay_some(*rc::gen::inRange(1, 60), touched);
    } else {
      const auto op = active[which] ? LabelRequest::Op::kUndo : LabelRequest::Op::kRedo;
      apply("u" + std::to_string(step), asked(a_few, op, "l" + std::to_string(which)));
      active[which] = !active[which];
    }
  }
  while (a_few.lay_some(1, touched)) {
  }
  for (int x = -60; x < 60; ++x) {
    for (int y = -60; y < 60; ++y) RC_ASSERT(a_few.at({x, y, 0}) == at_once.at({x, y, 0}));
  }
}

RC_GTEST_PROP(Anchor, NoVoxelIsLostOnTheWay, ()) {
  const Transform then = turned(*rc::gen::inRange(-50, 50) * 0.07, 0.3, *rc::gen::inRange(0, 360));
  const Transform now = turned(0.2, *rc::gen::inRange(-50, 50) * 0.07, *rc::gen::inRange(0, 360));
  BrickMasks one;
  one.insert({*rc::gen::inRange(-40, 40), *rc::gen::inRange(-40, 40), 3});
  const BrickMasks moved = followed(one.sorted(), then, now, kResolution);
  RC_ASSERT(moved.count() >= 1);
  const Eigen::Vector3d middle = now * then.inverse() * centre_of(one.voxels()[0], kResolution);
  for (const VoxelIndex v : moved.voxels()) {
    RC_ASSERT((centre_of(v, kResolution) - middle).norm() < 2 * 0.87 * 2 * kResolution);
  }
}

}  // namespace
}  // namespace concord
