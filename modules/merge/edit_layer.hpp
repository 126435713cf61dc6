#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/brick_set.hpp"
#include "core/corrections.hpp"
#include "core/error.hpp"
#include "core/pins.hpp"

namespace concord {

/// The voxels of one edit by the bricks that they lie in, in ascending order.
using PinnedBricks = std::vector<std::pair<BrickIndex, PinBrick>>;
[[nodiscard]] PinnedBricks by_brick(const Correction::Edit& edit);

/// Of all edits, undone ones included, each brick counted for every edit that pins anything in it: with what they lead
/// to some hundred bytes each. A wall of 20 m takes some 800 at 5 cm.
inline constexpr std::int64_t kMaxPinnedBricks = 2'000'000;

/// An edit's voxels as they are kept: only the words of its masks that are not empty, since scattered voxels have one
/// in a brick of sixteen.
class KeptPins {
 public:
  explicit KeptPins(const PinnedBricks& bricks);

  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] BrickIndex index(std::size_t i) const { return entries_[i].index; }
  [[nodiscard]] PinBrick pins(std::size_t i) const;
  /// @pre one of its bricks.
  [[nodiscard]] PinBrick pins_in(BrickIndex index) const;
  [[nodiscard]] PinnedBricks expanded() const;
  /// Of memory.
  [[nodiscard]] std::size_t bytes() const { return entries_.capacity() * sizeof(Entry) + words_.capacity() * 8; }

 private:
  struct Entry {
    BrickIndex index;
    std::uint8_t occupied, free;  ///< bit i: word i is kept
    std::uint32_t first;          ///< of its words
  };
  std::vector<Entry> entries_;  ///< ascending
  std::vector<std::uint64_t> words_;
};

/// What people corrected. The pins are a function of which edits are active: the latest active edit wins in its voxels,
/// by the order in which edits were first made. So undo and redo work in any order, and undoing all shows what the
/// sensors say. Edits stand above every sensor and outlive re-alignment, because they are kept apart from the layers.
///
/// An edit costs what its own bricks cost, however many were made before; undo and redo cost the edits in its bricks.
class EditLayer {
 public:
  /// Adds the bricks whose pins change to `touched`. @pre no edit of this id was made; `revision` is above all before.
  void apply(std::int64_t revision, const std::string& id, const PinnedBricks& bricks, BrickSet& touched);

  /// Whether there is room for one more: kTooLarge, over kMaxPins or kMaxPinnedBricks of all edits.
  [[nodiscard]] Result<void> check(const PinnedBricks& bricks) const;
  /// The same for several that pin so many voxels, in so many bricks.
  [[nodiscard]] Result<void> check_room(std::int64_t pins, std::int64_t bricks) const;
  /// Whether an edit can be taken back, or brought back: kNotFound; kConflict if it is undone, or active, already.
  [[nodiscard]] Result<void> check(const Correction::Undo& undo) const;
  /// @pre check(undo) and `revision` is above all before.
  void apply(std::int64_t revision, const Correction::Undo& undo, BrickSet& touched);

  /// Whether an operation later than `base` (an edit made, undone or redone) has a voxel in common with these. Those of
  /// `known` that hold do not count.
  [[nodiscard]] bool changed_since(const PinnedBricks& bricks, std::int64_t base,
                                   const std::vector<std::string>& known = {}) const;

  [[nodiscard]] bool contains(const std::string& edit_id) const { return by_id_.contains(edit_id); }
  /// @pre contains(edit_id).
  [[nodiscard]] bool is_active(const std::string& edit_id) const { return edits_[by_id_.at(edit_id)].active; }
  [[nodiscard]] PinnedBricks bricks_of(const std::string& edit_id) const {
    return edits_[by_id_.at(edit_id)].pins.expanded();
  }
  [[nodiscard]] const PinMap& pins() const { return pins_; }

 private:
  struct Kept {
    KeptPins pins;
    bool active = true;
    std::int64_t last_revision = 0;  ///< when it was made, undone or redone last
  };
  struct History {
    std::vector<std::uint32_t> edits;  ///< that pin anything in this brick, ascending
    std::int64_t last_revision = 0;    ///< of any of them
  };

  void refresh(BrickIndex index, const History& history, BrickSet& touched);
  std::deque<Kept> edits_;  ///< in the order in which they were made
  std::map<std::string, std::uint32_t, std::less<>> by_id_;
  std::unordered_map<BrickIndex, History, IndexHash> by_brick_;
  PinMap pins_;
  std::int64_t pin_count_ = 0, brick_count_ = 0;  ///< of all edits
};

}  // namespace concord
