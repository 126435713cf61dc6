#include "merge/edit_layer.hpp"

#include <map>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace concord {
namespace {

using Pin = PinMap::Pin;

Edit edit_of(const std::string& id, std::vector<VoxelIndex> added, std::vector<VoxelIndex> deleted) {
  return {id, "eva", 0, std::move(added), std::move(deleted)};
}

TEST(EditLayer, LatestActiveEditWinsInItsVoxels) {
  EditLayer layer;
  BrickSet touched;
  layer.apply(edit_of("one", {{0, 0, 0}, {0, 0, 1}}, {}), touched);
  layer.apply(edit_of("two", {}, {{0, 0, 1}}), touched);
  EXPECT_EQ(layer.pins().at({0, 0, 0}), Pin::kAdded);
  EXPECT_EQ(layer.pins().at({0, 0, 1}), Pin::kDeleted);
  ASSERT_TRUE(layer.undo("two", touched));
  EXPECT_EQ(layer.pins().at({0, 0, 1}), Pin::kAdded);
  ASSERT_TRUE(layer.undo("one", touched));
  EXPECT_TRUE(layer.pins().empty());
  ASSERT_TRUE(layer.redo("two", touched));
  ASSERT_TRUE(layer.redo("one", touched));
  EXPECT_EQ(layer.pins().at({0, 0, 1}), Pin::kDeleted) << "an edit keeps its place in the history";
}

TEST(EditLayer, SaysWhatCannotBeUndone) {
  EditLayer layer;
  BrickSet touched;
  EXPECT_EQ(layer.undo("none", touched).error().code, Code::kNotFound);
  layer.apply(edit_of("one", {{0, 0, 0}}, {}), touched);
  EXPECT_EQ(layer.redo("one", touched).error().code, Code::kConflict);
  ASSERT_TRUE(layer.undo("one", touched));
  EXPECT_EQ(layer.undo("one", touched).error().code, Code::kConflict);
}

TEST(EditLayer, TouchesOnlyBricksWhosePinsChange) {
  EditLayer layer;
  BrickSet first, second;
  layer.apply(edit_of("one", {{0, 0, 0}, {100, 0, 0}}, {}), first);
  EXPECT_EQ(first.size(), 2u);
  layer.apply(edit_of("two", {{0, 0, 0}, {0, 9, 0}}, {}), second);
  EXPECT_EQ(second.size(), 1u) << "pinned alike before";
}

/// The rule itself: edits in their order, those that are active.
class Naive {
 public:
  void apply(const Edit& edit) { edits_.push_back({edit, true}); }
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
  std::vector<std::pair<Edit, bool>> edits_;
};

RC_GTEST_PROP(EditLayer, AnyOrderOfUndoAndRedoIsTheRule, (std::uint32_t seed)) {
  std::mt19937 random(seed);
  EditLayer layer;
  Naive naive;
  PinMap before;
  std::vector<bool> active;
  std::vector<std::string> ids;
  for (int step = 0; step < 80; ++step) {
    BrickSet touched;
    if (active.empty() || random() % 2 == 0) {
      std::map<VoxelIndex, bool> voxels;
      const auto c = [&] { return static_cast<std::int32_t>(random() % 12) - 6; };
      for (int i = 0; i < 15; ++i) voxels[{c(), c(), c()}] = random() % 2 == 0;
      Edit edit = edit_of("edit" + std::to_string(step), {}, {});
      for (const auto& [voxel, add] : voxels) (add ? edit.added : edit.deleted).push_back(voxel);
      layer.apply(edit, touched);
      naive.apply(edit);
      active.push_back(true);
      ids.push_back(edit.id);
    } else {
      const std::size_t i = random() % active.size();
      const std::string& id = ids[i];
      const auto done = active[i] ? layer.undo(id, touched) : layer.redo(id, touched);
      RC_ASSERT(done.has_value());
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
