#include "merge/edit_layer.hpp"

#include <algorithm>
#include <cassert>

namespace concord {
namespace {

/// The later one wins in its voxels.
void lay_over(PinBrick& below, const PinBrick& above) {
  for (int word = 0; word < 8; ++word) {
    const std::uint64_t covered = above.occupied[word] | above.free[word];
    below.occupied[word] = (below.occupied[word] & ~covered) | above.occupied[word];
    below.free[word] = (below.free[word] & ~covered) | above.free[word];
  }
}

std::vector<std::pair<BrickIndex, PinBrick>> by_brick(const Edit& edit) {
  std::map<BrickIndex, PinBrick> bricks;
  const auto put = [&](VoxelIndex voxel, VoxelMask PinBrick::*mask) {
    const int local = local_of(voxel);
    (bricks[brick_of(voxel)].*mask)[local / 64] |= std::uint64_t{1} << (local % 64);
  };
  for (const VoxelIndex voxel : edit.added) put(voxel, &PinBrick::occupied);
  for (const VoxelIndex voxel : edit.deleted) put(voxel, &PinBrick::free);
  return {bricks.begin(), bricks.end()};
}

}  // namespace

void EditLayer::apply(const Edit& edit, BrickSet& touched) {
  assert(!contains(edit.id));
  const auto number = static_cast<std::uint32_t>(edits_.size());
  by_id_[edit.id] = number;
  edits_.push_back({by_brick(edit), true});
  for (const auto& [index, pins] : edits_.back().bricks) {
    by_brick_[index].push_back(number);
    refresh(index, touched);
  }
}

Result<void> EditLayer::undo(const std::string& edit_id, BrickSet& touched) { return activate(edit_id, false, touched); }

Result<void> EditLayer::redo(const std::string& edit_id, BrickSet& touched) { return activate(edit_id, true, touched); }

Result<void> EditLayer::activate(const std::string& edit_id, bool active, BrickSet& touched) {
  const auto it = by_id_.find(edit_id);
  if (it == by_id_.end()) return refuse(Code::kNotFound, "no edit " + edit_id + "; see: concord history");
  Kept& edit = edits_[it->second];
  if (edit.active == active) {
    return refuse(Code::kConflict, "edit " + edit_id + (active ? " is not undone" : " is undone already"));
  }
  edit.active = active;
  for (const auto& [index, pins] : edit.bricks) refresh(index, touched);
  return {};
}

void EditLayer::refresh(BrickIndex index, BrickSet& touched) {
  PinBrick pins;
  for (const std::uint32_t edit : by_brick_[index]) {
    if (edits_[edit].active) lay_over(pins, pins_of(edit, index));
  }
  if (pins_.set(index, pins)) touched.insert(index);
}

const PinBrick& EditLayer::pins_of(std::uint32_t edit, BrickIndex index) const {
  const auto& bricks = edits_[edit].bricks;
  const auto it = std::lower_bound(bricks.begin(), bricks.end(), index,
                                   [](const auto& entry, BrickIndex wanted) { return entry.first < wanted; });
  assert(it != bricks.end() && it->first == index);
  return it->second;
}

}  // namespace concord
