#include "semantic/labels/labels.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "semantic/labels/label_view.hpp"

namespace concord {
namespace {

using Op = LabelRequest::Op;

std::vector<VoxelIndex> row(std::int32_t first, std::int32_t last, std::int32_t y = 0) {
  std::vector<VoxelIndex> out;
  for (std::int32_t x = first; x <= last; ++x) out.push_back({x, y, 0});
  return out;
}

/// Labels as a process keeps them: checked, then applied.
class World {
 public:
  Result<Labels::Made> ask(LabelRequest request, const std::vector<VoxelIndex>& voxels = {}) {
    request.id = "r" + std::to_string(++asked_);
    auto what = labels.check(request, voxels);
    if (!what) return tl::unexpected(what.error());
    const LabelCorrection correction{labels.revision() + 1, request.id, "eva", 0, 1, std::move(*what)};
    corrections.push_back(correction);
    touched.clear();
    labels.apply(correction, touched);
    return *labels.find(request.id);
  }
  Result<Labels::Made> label(const std::string& name, const std::vector<VoxelIndex>& voxels,
                             std::uint32_t instance = 0) {
    LabelRequest request;
    request.name = name;
    request.of.instance = instance;
    return ask(request, voxels);
  }
  Result<Labels::Made> change(Op op, InstanceId of, const std::string& name = "", std::uint32_t to = 0) {
    LabelRequest request;
    request.op = op;
    request.of = of;
    request.name = name;
    request.to_instance = to;
    return ask(request);
  }
  Result<Labels::Made> undo(const std::string& id, bool redo = false) {
    LabelRequest request;
    request.op = redo ? Op::kRedo : Op::kUndo;
    request.correction_id = id;
    return ask(request);
  }
  [[nodiscard]] std::string last() const { return "r" + std::to_string(asked_); }

  Labels labels{0.1};
  std::vector<LabelCorrection> corrections;
  BrickSet touched;

 private:
  int asked_ = 0;
};

TEST(Labels, ClassesAndInstancesCountFromOneAndNoNumberIsGivenTwice) {
  World world;
  EXPECT_EQ(world.label("chair", row(0, 3))->of, (InstanceId{1, 1}));
  EXPECT_EQ(world.label("chair", row(4, 6))->of, (InstanceId{1, 2}));
  EXPECT_EQ(world.label("table", row(7, 9))->of, (InstanceId{2, 1}));
  ASSERT_TRUE(world.change(Op::kTakeOff, {1, 2}));
  EXPECT_EQ(world.label("chair", row(4, 6))->of, (InstanceId{1, 3}));
  ASSERT_TRUE(world.undo("r1"));
  EXPECT_EQ(world.label("chair", row(0, 3))->of, (InstanceId{1, 4}));
}

TEST(Labels, TheLaterOneHasSharedVoxelsAndUndoGivesThemBackInAnyOrder) {
  World world;
  const InstanceId a = world.label("a", row(0, 5))->of, b = world.label("b", row(3, 8))->of,
                   c = world.label("c", row(4, 4))->of;
  EXPECT_EQ(world.labels.at({2, 0, 0}), a);
  EXPECT_EQ(world.labels.at({3, 0, 0}), b);
  EXPECT_EQ(world.labels.at({4, 0, 0}), c);
  ASSERT_TRUE(world.undo("r2"));
  EXPECT_EQ(world.labels.at({3, 0, 0}), a);
  EXPECT_EQ(world.labels.at({4, 0, 0}), c);
  EXPECT_EQ(world.labels.at({7, 0, 0}), std::nullopt);
  ASSERT_TRUE(world.undo("r3"));
  EXPECT_EQ(world.labels.at({4, 0, 0}), a);
  ASSERT_TRUE(world.undo("r2", true));
  EXPECT_EQ(world.labels.at({4, 0, 0}), b);
  EXPECT_EQ(world.undo("r2", true).error().code, Code::kConflict);
  EXPECT_EQ(world.undo("nobody").error().code, Code::kNotFound);
}

TEST(Labels, AnInstanceMayGrowAndBecomeAnotherClass) {
  World world;
  const InstanceId chair = world.label("chair", row(0, 2))->of;
  EXPECT_EQ(world.label("chair", row(3, 4), chair.instance)->of, chair);
  ASSERT_TRUE(world.label("table", row(8, 9)));
  const InstanceId now = world.change(Op::kReassign, chair, "table")->of;
  EXPECT_EQ(now, (InstanceId{2, 2}));
  EXPECT_EQ(world.labels.at({4, 0, 0}), now);
  ASSERT_TRUE(world.change(Op::kTakeOff, {2, 0}));
  EXPECT_EQ(world.labels.at({4, 0, 0}), std::nullopt);
  EXPECT_EQ(world.labels.at({8, 0, 0}), std::nullopt);
  ASSERT_TRUE(world.undo(world.last()));
  EXPECT_EQ(world.labels.at({4, 0, 0}), now);
  ASSERT_TRUE(world.undo("r4"));
  EXPECT_EQ(world.labels.at({4, 0, 0}), chair);
}

TEST(Labels, RenamingIsUndoneUnlessTheNameWentToAnother) {
  World world;
  ASSERT_TRUE(world.label("chair", row(0, 2)));
  ASSERT_TRUE(world.change(Op::kRename, {1, 0}, "armchair"));
  EXPECT_EQ(world.labels.class_called("armchair"), 1U);
  EXPECT_EQ(world.labels.class_called("chair"), std::nullopt);
  ASSERT_TRUE(world.label("chair", row(5, 6)));
  EXPECT_EQ(world.labels.class_called("chair"), 2U);
  EXPECT_EQ(world.undo("r2").error().code, Code::kConflict);
  EXPECT_EQ(world.change(Op::kRename, {1, 0}, "chair").error().code, Code::kExists);
  ASSERT_TRUE(world.change(Op::kRename, {2, 0}, "stool"));
  ASSERT_TRUE(world.undo("r2"));
  EXPECT_EQ(world.labels.class_called("chair"), 1U);
}

TEST(Labels, RefusesWhatIsNoLabelAndChangesNothing) {
  World world;
  EXPECT_EQ(world.label("chair", {}).error().code, Code::kEmpty);
  for (const std::string& name : {std::string(), std::string("a/b"), std::string(81, 'a'), std::string("a\nb"),
                                  std::string("\xC3\x28"), std::string("a\0b", 3)}) {
    EXPECT_EQ(world.label(name, row(0, 1)).error().code, Code::kBadName) << name;
  }
  EXPECT_EQ(world.label("chair", {{kMaxVoxel, 0, 0}}).error().code, Code::kOutOfBounds);
  EXPECT_EQ(world.label("chair", row(0, 1), 7).error().code, Code::kNotFound);
  EXPECT_EQ(world.change(Op::kTakeOff, {1, 1}).error().code, Code::kNotFound);
  EXPECT_EQ(world.change(Op::kReassign, {1, 1}, "x").error().code, Code::kNotFound);
  EXPECT_EQ(world.labels.revision(), 0);
  EXPECT_TRUE(world.labels.classes().empty());
}

TEST(Labels, RestoredNumbersStayAndTheNextOnesFollow) {
  World world;
  LabelRequest request;
  request.op = Op::kRestore;
  request.name = "chair";
  request.of = {7, 40};
  EXPECT_EQ(world.ask(request, row(0, 1))->of, (InstanceId{7, 40}));
  EXPECT_EQ(world.label("chair", row(2, 3))->of, (InstanceId{7, 41}));
  EXPECT_EQ(world.label("table", row(2, 3))->of, (InstanceId{8, 1}));
  request.name = "table";
  EXPECT_EQ(world.ask(request, row(0, 1)).error().code, Code::kConflict);
  request.of = {9, 1};
  EXPECT_EQ(world.ask(request, row(0, 1)).error().code, Code::kConflict);
}

/// However high one number is, those below it that nobody was given are nobody's, and all that are given are counted.
TEST(Labels, NumbersThatWereNeverGivenAreNone) {
  World world;
  LabelRequest restore;
  restore.op = Op::kRestore;
  restore.name = "chair";
  restore.of = {1, 1U << 30};
  ASSERT_TRUE(world.ask(restore, row(0, 1)));
  LabelRequest more;
  more.op = Op::kLabel;
  more.name = "chair";
  more.of = {1, 5};
  EXPECT_EQ(world.ask(more, row(2, 3)).error().code, Code::kNotFound);
  LabelRequest reassign;
  reassign.op = Op::kReassign;
  reassign.of = {1, 1U << 30};
  reassign.name = "chair";
  reassign.to_instance = 5;
  EXPECT_EQ(world.ask(reassign, {}).error().code, Code::kNotFound);
  for (std::uint32_t number = 1; number < kMaxInstances; ++number) {
    restore.of.instance = number;
    ASSERT_TRUE(world.ask(restore, row(0, 1))) << number;
  }
  restore.of.instance = kMaxInstances;
  EXPECT_EQ(world.ask(restore, row(0, 1)).error().code, Code::kTooLarge);
}

TEST(LabelView, ALabelShowsWhereItsVoxelsAreOccupied) {
  World world;
  BrickMap map;
  LabelView view(world.labels, map, 0.1);
  const InstanceId chair = world.label("chair", row(0, 3))->of;
  EXPECT_FALSE(view.refresh({0, 0, 0}));
  DenseBrick dense;
  dense.fill(kFree);
  dense[1] = dense[2] = dense[5] = kOccupied;
  map.set({0, 0, 0}, Brick::from_dense(dense));
  EXPECT_TRUE(view.refresh({0, 0, 0}));
  EXPECT_EQ(view.voxels_of(chair), row(1, 2));
  const LabelInstance shown = view.instance(chair);
  EXPECT_EQ(shown.voxels, 2);
  EXPECT_NEAR(shown.centroid.x(), 0.2, 1e-12);
  LabelQuery query;
  query.kind = LabelQuery::Kind::kAt;
  query.p_map = {0.15, 0.05, 0.05};
  EXPECT_EQ(view.answer(query)->at(0).of, chair);
  query.p_map = {0.55, 0.05, 0.05};
  EXPECT_TRUE(view.answer(query)->empty());
  query.kind = LabelQuery::Kind::kWithin;
  query.radius = 0.31;
  EXPECT_EQ(view.answer(query)->size(), 1U);
  query.radius = 0.29;
  EXPECT_TRUE(view.answer(query)->empty());
  query.kind = LabelQuery::Kind::kBorder;
  query.name = "chair";
  // Beside (1, 0, 0): x = 0, y = 1, z = 1; beside (2, 0, 0): x = 3, y = 1, z = 1. Below 0 nothing is known.
  EXPECT_EQ(view.answer(query)->at(0).voxels, 6);
  query.name = "table";
  EXPECT_EQ(view.answer(query).error().code, Code::kNotFound);
}

/// The same, told from the beginning, voxel by voxel.
std::map<VoxelIndex, InstanceId> oracle(const std::vector<LabelCorrection>& corrections) {
  std::map<std::string, bool> active;
  for (const LabelCorrection& one : corrections) {
    active[one.id] = true;
    if (const auto* undo = std::get_if<LabelCorrection::Undo>(&one.what)) active[undo->correction_id] = undo->redo;
  }
  struct Said {
    const std::vector<VoxelIndex>* voxels;
    InstanceId holder;
    bool alive;
  };
  std::vector<Said> said;
  for (const LabelCorrection& one : corrections) {
    if (!active.at(one.id)) continue;
    if (const auto* claim = std::get_if<LabelCorrection::Claim>(&one.what))
      said.push_back({&claim->voxels, claim->of, true});
    for (Said& before : said) {
      if (const auto* reassign = std::get_if<LabelCorrection::Reassign>(&one.what)) {
        if (before.alive && before.holder == reassign->from) before.holder = reassign->to;
      } else if (const auto* off = std::get_if<LabelCorrection::TakeOff>(&one.what)) {
        const bool hit = before.holder == off->of || (off->of.instance == 0 && before.holder.label == off->of.label);
        if (hit) before.alive = false;
      }
    }
  }
  std::map<VoxelIndex, InstanceId> out;
  for (const Said& one : said) {
    for (const VoxelIndex v : *one.voxels) {
      if (one.alive) out[v] = one.holder;
    }
  }
  return out;
}

RC_GTEST_PROP(LabelsProperty, AnyHistoryIsItsFold, ()) {
  World world;
  BrickMap map;
  for (std::int32_t x = 0; x < 4; ++x) map.set({x, 0, 0}, Brick::uniform({~0ULL, 0, 0, 0, 0, 0, 0, 0}, kOccupied));
  LabelView view(world.labels, map, 0.1);
  const int steps = *rc::gen::inRange(1, 40);
  for (int i = 0; i < steps; ++i) {
    const auto some = [](int most) { return static_cast<std::uint32_t>(*rc::gen::inRange(1, most)); };
    const std::string name(1, static_cast<char>('a' + *rc::gen::inRange(0, 3)));
    const int kind = *rc::gen::inRange(0, 10);
    if (kind < 4) {
      const auto first = *rc::gen::inRange(0, 24);
      (void)world.label(name, row(first, first + *rc::gen::inRange(0, 8), *rc::gen::inRange(0, 2)),
                        *rc::gen::inRange(0, 2) == 0 ? 0 : some(3));
    } else if (kind < 5) {
      (void)world.change(Op::kReassign, {some(4), some(4)}, name, *rc::gen::inRange(0, 2) == 0 ? 0 : some(3));
    } else if (kind < 7) {
      (void)world.change(Op::kTakeOff, {some(4), *rc::gen::inRange(0, 3) == 0 ? 0 : some(4)});
    } else {
      (void)world.undo("r" + std::to_string(some(i + 2)), kind == 9);
    }
    for (const auto& [tile, bricks] : world.touched.sorted()) {
      for (int local = 0; local < 64; ++local) {
        if ((bricks >> local & 1) != 0) view.refresh(brick_at(tile, local));
      }
    }
  }
  const auto truth = oracle(world.corrections);
  Labels again{0.1};
  BrickSet touched;
  for (const LabelCorrection& one : world.corrections) again.apply(one, touched);
  for (std::int32_t x = -1; x < 34; ++x) {
    for (std::int32_t y = -1; y < 3; ++y) {
      const VoxelIndex v{x, y, 0};
      const auto it = truth.find(v);
      const auto expected = it != truth.end() ? std::optional(it->second) : std::nullopt;
      RC_ASSERT(world.labels.at(v) == expected);
      RC_ASSERT(again.at(v) == expected);
      // What was refreshed is what was touched: so nothing that changed was left out.
      const LogOdds shown = view.shown().at(v);
      RC_ASSERT(is_known(shown) == expected.has_value());
      if (expected) RC_ASSERT(view.slots()[static_cast<std::size_t>(slot_of_value(shown))].of == *expected);
    }
  }
}

TEST(Labels, WhatIsUndoneLeavesRoomForOthers) {
  World world;
  std::vector<VoxelIndex> block;
  for (std::int32_t z = 0; z < 50; ++z) {
    for (std::int32_t y = 0; y < 100; ++y) {
      for (std::int32_t x = 0; x < 100; ++x) block.push_back({x, y, z});
    }
  }
  std::ranges::sort(block);
  ASSERT_EQ(static_cast<std::int64_t>(block.size()), kMaxLabelVoxels);
  for (std::int64_t i = 0; i < kMaxAllLabelVoxels / kMaxLabelVoxels; ++i) ASSERT_TRUE(world.label("box", block));
  EXPECT_EQ(world.label("box", {{0, 0, 0}}).error().code, Code::kTooLarge);
  ASSERT_TRUE(world.undo("r1"));
  ASSERT_TRUE(world.label("box", {{0, 0, 0}}));
  EXPECT_EQ(world.undo("r1", true).error().code, Code::kTooLarge);
  ASSERT_TRUE(world.undo("r2"));
  EXPECT_TRUE(world.undo("r1", true));
}

TEST(Labels, VoxelsThatStandApartAreBoundedByTheBricksThatTheyTake) {
  World world;
  std::int64_t bricks = 0;
  const auto scattered = [](std::int32_t z) {
    std::vector<VoxelIndex> out;
    for (std::int32_t x = 0; x < 700; ++x) {
      for (std::int32_t y = 0; y < 700; ++y) out.push_back({8 * x, 8 * y, 8 * z});
    }
    return out;
  };
  std::int32_t z = 0;
  for (; bricks + 700 * 700 <= kMaxLabelBricks; bricks += 700 * 700) ASSERT_TRUE(world.label("dust", scattered(z++)));
  ASSERT_TRUE(world.undo("r1"));
  EXPECT_EQ(world.label("dust", scattered(z)).error().code, Code::kTooLarge) << "undone ones can come back";
  std::vector<VoxelIndex> block;
  for (std::int32_t i = 0; i < 8 * 8 * 8 * 800; ++i) block.push_back(voxel_at({i / 512, -1, 0}, i % 512));
  std::ranges::sort(block);
  EXPECT_TRUE(world.label("block", block)) << "as many voxels, in few bricks";
}

TEST(Labels, ModelsThatMoveTakeNoRoomFromLabelsOfPeople) {
  World world;
  BrickSet touched;
  std::vector<VoxelIndex> block;
  for (std::int32_t i = 0; i < 500'000; ++i) block.push_back(voxel_at({i / 512, 0, 0}, i % 512));
  std::ranges::sort(block);
  for (int i = 1; i <= 110; ++i) {
    const std::string edit = "asset-m" + std::to_string(i), before = i > 1 ? "asset-m" + std::to_string(i - 1) : "";
    const LabelCorrection::Claim claim{
        {1, 1}, i == 1 ? "lift" : "", block, edit, {}, {"lift", Transform::Identity(), before}};
    world.labels.apply({i, "m" + std::to_string(i), "eva", 0, 1, claim}, touched);
  }
  EXPECT_EQ(world.labels.moved_voxels(), 109 * 500'000);
  EXPECT_EQ(world.labels.waiting(1).at(0).edit_id, "asset-m1");
  world.labels.set_edit("asset-m1", {true, 1, false}, touched);
  EXPECT_EQ(world.labels.waiting(1).at(0).edit_id, "asset-m10") << "just what merge has said nothing of";
  EXPECT_EQ(world.labels.model_of({1, 1})->asset, "lift");
  EXPECT_TRUE(world.label("box", row(0, 3, -9)));
}

}  // namespace
}  // namespace concord
