#include "merge/edit_layer.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <set>

#include "core/correction_check.hpp"

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

std::int64_t count_of(const PinnedBricks& bricks) {
  std::int64_t count = 0;
  for (const auto& [index, pins] : bricks) {
    for (int word = 0; word < 8; ++word) count += std::popcount(pins.occupied[word] | pins.free[word]);
  }
  return count;
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

KeptPins::KeptPins(const PinnedBricks& bricks) {
  std::size_t words = 0;
  const auto is_kept = [](std::uint64_t word) { return word != 0; };
  for (const auto& [index, pins] : bricks) {
    words += static_cast<std::size_t>(std::ranges::count_if(pins.occupied, is_kept) +
                                      std::ranges::count_if(pins.free, is_kept));
  }
  entries_.reserve(bricks.size());
  words_.reserve(words);
  const auto keep = [&](const VoxelMask& mask) {
    unsigned kept = 0;
    for (unsigned i = 0; i < 8; ++i) {
      if (mask[i] == 0) continue;
      kept |= 1U << i;
      words_.push_back(mask[i]);
    }
    return static_cast<std::uint8_t>(kept);
  };
  for (const auto& [index, pins] : bricks) {
    const auto first = static_cast<std::uint32_t>(words_.size());
    const std::uint8_t occupied = keep(pins.occupied);
    entries_.push_back({index, occupied, keep(pins.free), first});
  }
}

PinBrick KeptPins::pins(std::size_t i) const {
  const Entry& entry = entries_[i];
  PinBrick out;
  std::size_t next = entry.first;
  for (unsigned word = 0; word < 8; ++word) {
    if ((entry.occupied >> word & 1) != 0) out.occupied[word] = words_[next++];
  }
  for (unsigned word = 0; word < 8; ++word) {
    if ((entry.free >> word & 1) != 0) out.free[word] = words_[next++];
  }
  return out;
}

PinBrick KeptPins::pins_in(BrickIndex index) const {
  const auto it = std::ranges::lower_bound(entries_, index, {}, &Entry::index);
  assert(it != entries_.end() && it->index == index);
  return pins(static_cast<std::size_t>(it - entries_.begin()));
}

PinnedBricks KeptPins::expanded() const {
  PinnedBricks bricks;
  bricks.reserve(size());
  for (std::size_t i = 0; i < size(); ++i) bricks.emplace_back(index(i), pins(i));
  return bricks;
}

Result<void> EditLayer::check(const PinnedBricks& bricks) const {
  return check_room(count_of(bricks), static_cast<std::int64_t>(bricks.size()));
}

Result<void> EditLayer::check_room(std::int64_t pins, std::int64_t bricks) const {
  if (pins > kMaxPins - pin_count_) {
    return refuse(Code::kTooLarge, "all edits together, undone ones too, may pin " + std::to_string(kMaxPins) +
                                       " voxels; save the map and begin with a new state folder");
  }
  if (bricks > kMaxPinnedBricks - brick_count_) {
    return refuse(Code::kTooLarge, "all edits together, undone ones too, may lie in " +
                                       std::to_string(kMaxPinnedBricks) +
                                       " bricks of 8 voxels; save the map and begin with a new state folder");
  }
  return {};
}

void EditLayer::apply(std::int64_t revision, const std::string& id, const PinnedBricks& bricks, BrickSet& touched) {
  assert(!contains(id));
  const auto number = static_cast<std::uint32_t>(edits_.size());
  by_id_[id] = number;
  edits_.push_back({KeptPins(bricks), true, revision});
  pin_count_ += count_of(bricks);
  brick_count_ += static_cast<std::int64_t>(bricks.size());
  for (const auto& [index, pins] : bricks) {
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
  for (std::size_t i = 0; i < edit.pins.size(); ++i) {
    const BrickIndex index = edit.pins.index(i);
    History& history = by_brick_.at(index);
    history.last_revision = revision;
    refresh(index, history, touched);
  }
}

void EditLayer::refresh(BrickIndex index, const History& history, BrickSet& touched) {
  PinBrick pins;
  for (const std::uint32_t edit : history.edits) {
    if (edits_[edit].active) lay_over(pins, edits_[edit].pins.pins_in(index));
  }
  if (pins_.set(index, pins)) touched.insert(index);
}

bool EditLayer::changed_since(const PinnedBricks& bricks, std::int64_t base,
                              const std::vector<std::string>& known) const {
  std::set<std::uint32_t> no_change;
  for (const std::string& id : known) {
    if (const auto it = by_id_.find(id); it != by_id_.end() && edits_[it->second].active) no_change.insert(it->second);
  }
  return std::ranges::any_of(bricks, [&](const auto& entry) {
    const BrickIndex index = entry.first;
    const PinBrick& pins = entry.second;  // clang 14 captures no structured binding
    const auto it = by_brick_.find(index);
    if (it == by_brick_.end() || it->second.last_revision <= base) return false;
    return std::ranges::any_of(it->second.edits, [&](std::uint32_t edit) {
      return edits_[edit].last_revision > base && !no_change.contains(edit) &&
             share_a_voxel(pins, edits_[edit].pins.pins_in(index));
    });
  });
}

}  // namespace concord
