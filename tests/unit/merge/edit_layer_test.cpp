#include "merge/edit_layer.hpp"

#include <map>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace concord {
namespace {

using Pin = PinMap::Pin;

Correction::Edit edit_of(std::vector<VoxelIndex> added, std::vector<VoxelIndex> deleted) {
  return {EditRequest::Op::kAdd, std::move(added), std::move(deleted)};
}

/// An edit layer that counts revisions by itself.
struct Counting {
  EditLayer layer;
  BrickSet touched;
  std::int64_t revision = 0;

  void apply(const std::string& id, std::vector<VoxelIndex> added, std::vector<VoxelIndex> deleted) {
    layer.apply(++revision, id, by_brick(edit_of(std::move(added), std::move(deleted))), touched);
  }
  [[nodiscard]] Result<void> undo(const std::string& id, bool redo = false) {
    const auto can = layer.check({id, redo});
    if (can) layer.apply(++revision, Correction::Undo{id, redo}, touched);
    return can;
  }
  [[nodiscard]] Result<void> redo(const std::string& id) { return undo(id, true); }
};

TEST(EditLayer, LatestActiveEditWinsInItsVoxels) {
  Counting edits;
  edits.apply("one", {{0, 0, 0}, {0, 0, 1}}, {});
  edits.apply("two", {}, {{0, 0, 1}});
  EXPECT_EQ(edits.layer.pins().at({0, 0, 0}), Pin::kAdded);
  EXPECT_EQ(edits.layer.pins().at({0, 0, 1}), Pin::kDeleted);
  ASSERT_TRUE(edits.undo("two"));
  EXPECT_EQ(edits.layer.pins().at({0, 0, 1}), Pin::kAdded);
  ASSERT_TRUE(edits.undo("one"));
  EXPECT_TRUE(edits.layer.pins().empty());
  ASSERT_TRUE(edits.redo("two"));
  ASSERT_TRUE(edits.redo("one"));
  EXPECT_EQ(edits.layer.pins().at({0, 0, 1}), Pin::kDeleted) << "an edit keeps its place in the history";
}

TEST(EditLayer, SaysWhatCannotBeUndone) {
  Counting edits;
  EXPECT_EQ(edits.undo("none").error().code, Code::kNotFound);
  edits.apply("one", {{0, 0, 0}}, {});
  EXPECT_EQ(edits.redo("one").error().code, Code::kConflict);
  ASSERT_TRUE(edits.undo("one"));
  EXPECT_EQ(edits.undo("one").error().code, Code::kConflict);
}

TEST(EditLayer, TouchesOnlyBricksWhosePinsChange) {
  Counting edits;
  edits.apply("one", {{0, 0, 0}, {100, 0, 0}}, {});
  EXPECT_EQ(edits.touched.size(), 2u);
  edits.touched.clear();
  edits.apply("two", {{0, 0, 0}, {0, 9, 0}}, {});
  EXPECT_EQ(edits.touched.size(), 1u) << "pinned alike before";
}

TEST(EditLayer, KeepsScatteredVoxelsInAFewBytesEach) {
  std::vector<VoxelIndex> added;
  for (int i = 0; i < 1000; ++i) added.push_back({8 * i, i % 8, 3});
  const PinnedBricks bricks = by_brick(edit_of(added, {{1, 1, 9}, {2, 1, 9}, {3, 1, 15}}));
  const KeptPins kept(bricks);
  EXPECT_EQ(kept.expanded(), bricks);
  EXPECT_LE(kept.bytes(), 32 * bricks.size());
}

TEST(EditLayer, AllEditsTogetherAreBounded) {
  Counting edits;
  std::vector<VoxelIndex> added;
  for (int i = 0; i < 250'000; ++i) added.push_back({8 * (i / 500), 8 * (i % 500), 0});
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(edits.layer.check(by_brick(edit_of(added, {}))));
    edits.apply("e" + std::to_string(i), added, {});
  }
  EXPECT_EQ(edits.layer.check(by_brick(edit_of({{0, 0, 0}}, {}))).error().code, Code::kTooLarge);
}

TEST(EditLayer, KnowsWhatChangedSince) {
  Counting edits;
  edits.apply("one", {{0, 0, 0}}, {});
  edits.apply("two", {{0, 0, 1}}, {});
  const auto changed = [&](VoxelIndex voxel, std::int64_t base, const std::vector<std::string>& known = {}) {
    return edits.layer.changed_since(by_brick(edit_of({}, {voxel})), base, known);
  };
  EXPECT_TRUE(changed({0, 0, 0}, 0));
  EXPECT_FALSE(changed({0, 0, 0}, 1)) << "the later edit in this brick has other voxels";
  EXPECT_TRUE(changed({0, 0, 1}, 1));
  EXPECT_FALSE(changed({0, 0, 1}, 2));
  EXPECT_FALSE(changed({50, 0, 1}, 0));
  EXPECT_FALSE(changed({0, 0, 0}, 0, {"two", "none", "one"})) << "the asker knows of it";
  EXPECT_TRUE(changed({0, 0, 0}, 0, {"two"}));
  ASSERT_TRUE(edits.undo("one"));
  EXPECT_TRUE(changed({0, 0, 0}, 2)) << "an undo is a change";
  EXPECT_TRUE(changed({0, 0, 0}, 2, {"one"})) << "and was not known";
  EXPECT_FALSE(changed({0, 0, 1}, 2));
}

/// The rule itself: edits in their order, those that are active.
class Naive {
 public:
  void apply(const Correction::Edit& edit) { edits_.push_back({edit, true}); }
  void set_active(std::size_t i, bool active) { edits_[i].second = active; }
  [[nodiscard]] PinMap pins() const {
    PinMap out;
    for (const auto& [edit, active] : edits_) {
      if (!active) continue;
      for (const VoxelIndex v : edit.added) out.set(v, Pin::kAdded);
      for (const VoxelIndex v : edit.deleted) out.set(v, Pin::kDeleted);
    }
    return out;
  }

 private:
  std::vector<std::pair<Correction::Edit, bool>> edits_;
};

Correction::Edit random_edit(std::mt19937& random) {
  std::map<VoxelIndex, bool> voxels;
  const auto c = [&] { return static_cast<std::int32_t>(random() % 12) - 6; };
  for (int i = 0; i < 15; ++i) voxels[{c(), c(), c()}] = random() % 2 == 0;
  Correction::Edit edit;
  for (const auto& [voxel, add] : voxels) (add ? edit.added : edit.deleted).push_back(voxel);
  return edit;
}

RC_GTEST_PROP(EditLayer, AnyOrderOfUndoAndRedoIsTheRule, (std::uint32_t seed)) {
  std::mt19937 random(seed);
  EditLayer layer;
  Naive naive;
  PinMap before;
  std::vector<bool> active;
  for (int step = 1; step <= 80; ++step) {
    BrickSet touched;
    if (active.empty() || random() % 2 == 0) {
      const Correction::Edit edit = random_edit(random);
      layer.apply(step, "edit" + std::to_string(active.size()), by_brick(edit), touched);
      naive.apply(edit);
      active.push_back(true);
    } else {
      const std::size_t i = random() % active.size();
      const Correction::Undo undo{"edit" + std::to_string(i), !active[i]};
      RC_ASSERT(layer.check(undo).has_value());
      layer.apply(step, undo, touched);
      active[i] = !active[i];
      naive.set_active(i, active[i]);
    }
    RC_ASSERT(layer.pins() == naive.pins());
    for (const BrickIndex index : layer.pins().sorted_bricks()) {
      const PinBrick* old = before.find(index);
      RC_ASSERT(touched.contains(index) || (old != nullptr && *old == *layer.pins().find(index)));
    }
    before = layer.pins();
  }
}

}  // namespace
}  // namespace concord
