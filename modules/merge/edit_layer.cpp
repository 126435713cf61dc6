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

bool share_a_voxel(const PinBrick& a, const PinBrick& b) {
  std::uint64_t shared = 0;
  for (int word = 0; word < 8; ++word) shared |= (a.occupied[word] | a.free[word]) & (b.occupied[word] | b.free[word]);
  return shared != 0;
}

}  // namespace

PinnedBricks by_brick(const Correction::Edit& edit) {
  std::unordered_map<BrickIndex, PinBrick, IndexHash> bricks;
  const auto put = [&](const std::vector<VoxelIndex>& voxels, VoxelMask PinBrick::*mask) {
    std::pair<const BrickIndex, PinBrick>* last = nullptr;  // neighbours in the list are neighbours in space
    for (const VoxelIndex voxel : voxels) {
      const BrickIndex index = brick_of(voxel);
      if (last == nullptr || last->first != index) last = &*bricks.try_emplace(index).first;
      const int local = local_of(voxel);
      (last->second.*mask)[local / 64] |= std::uint64_t{1} << (local % 64);
    }
  };
  put(edit.added, &PinBrick::occupied);
  put(edit.deleted, &PinBrick::free);
  PinnedBricks sorted(bricks.begin(), bricks.end());
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return sorted;
}

void EditLayer::apply(std::int64_t revision, const std::string& id, PinnedBricks bricks, BrickSet& touched) {
  assert(!contains(id));
  const auto number = static_cast<std::uint32_t>(edits_.size());
  by_id_[id] = number;
  edits_.push_back({std::move(bricks), true, revision});
  for (const auto& [index, pins] : edits_.back().bricks) {
    History& history = by_brick_[index];
    history.edits.push_back(number);
    history.last_revision = revision;
    const PinBrick* before = pins_.find(index);
    PinBrick after = before != nullptr ? *before : PinBrick{};
    lay_over(after, pins);  // the latest of all
    if (pins_.set(index, after)) touched.insert(index);
  }
}

Result<void> EditLayer::check(const Correction::Undo& undo) const {
  const auto it = by_id_.find(undo.edit_id);
  if (it == by_id_.end()) return refuse(Code::kNotFound, "no edit " + undo.edit_id + "; see: concord history");
  if (edits_[it->second].active == undo.redo) {
    return refuse(Code::kConflict, "edit " + undo.edit_id + (undo.redo ? " is not undone" : " is undone already"));
  }
  return {};
}

void EditLayer::apply(std::int64_t revision, const Correction::Undo& undo, BrickSet& touched) {
  assert(check(undo));
  Kept& edit = edits_[by_id_.at(undo.edit_id)];
  edit.active = undo.redo;
  edit.last_revision = revision;
  for (const auto& [index, pins] : edit.bricks) {
    History& history = by_brick_.at(index);
    history.last_revision = revision;
    refresh(index, history, touched);
  }
}

void EditLayer::refresh(BrickIndex index, const History& history, BrickSet& touched) {
  PinBrick pins;
  for (const std::uint32_t edit : history.edits) {
    if (edits_[edit].active) lay_over(pins, pins_of(edit, index));
  }
  if (pins_.set(index, pins)) touched.insert(index);
}

bool EditLayer::changed_since(const PinnedBricks& bricks, std::int64_t base) const {
  return std::ranges::any_of(bricks, [&](const auto& entry) {
    const auto& [index, pins] = entry;
    const auto it = by_brick_.find(index);
    if (it == by_brick_.end() || it->second.last_revision <= base) return false;
    return std::ranges::any_of(it->second.edits, [&](std::uint32_t edit) {
      return edits_[edit].last_revision > base && share_a_voxel(pins, pins_of(edit, index));
    });
  });
}

const PinBrick& EditLayer::pins_of(std::uint32_t edit, BrickIndex index) const {
  const auto& bricks = edits_[edit].bricks;
  const auto it = std::lower_bound(bricks.begin(), bricks.end(), index,
                                   [](const auto& entry, BrickIndex wanted) { return entry.first < wanted; });
  assert(it != bricks.end() && it->first == index);
  return it->second;
}

}  // namespace concord
