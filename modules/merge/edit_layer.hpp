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

/// What people corrected. The pins are a function of which edits are active: the latest active edit wins in its voxels,
/// by the order in which edits were first made. So undo and redo work in any order, and undoing all shows what the
/// sensors say. Edits stand above every sensor and outlive re-alignment, because they are kept apart from the layers.
///
/// An edit costs what its own bricks cost, however many were made before; undo and redo cost the edits in its bricks.
class EditLayer {
 public:
  /// Adds the bricks whose pins change to `touched`. @pre no edit of this id was made; `revision` is above all before.
  void apply(std::int64_t revision, const std::string& id, PinnedBricks bricks, BrickSet& touched);

  /// Whether an edit can be taken back, or brought back: kNotFound; kConflict if it is undone, or active, already.
  [[nodiscard]] Result<void> check(const Correction::Undo& undo) const;
  /// @pre check(undo) and `revision` is above all before.
  void apply(std::int64_t revision, const Correction::Undo& undo, BrickSet& touched);

  /// Whether an operation later than `base` (an edit made, undone or redone) has a voxel in common with these.
  [[nodiscard]] bool changed_since(const PinnedBricks& bricks, std::int64_t base) const;

  [[nodiscard]] bool contains(const std::string& edit_id) const { return by_id_.contains(edit_id); }
  /// @pre contains(edit_id).
  [[nodiscard]] bool is_active(const std::string& edit_id) const { return edits_[by_id_.at(edit_id)].active; }
  [[nodiscard]] const PinnedBricks& bricks_of(const std::string& edit_id) const {
    return edits_[by_id_.at(edit_id)].bricks;
  }
  [[nodiscard]] const PinMap& pins() const { return pins_; }

 private:
  struct Kept {
    PinnedBricks bricks;
    bool active = true;
    std::int64_t last_revision = 0;  ///< when it was made, undone or redone last
  };
  struct History {
    std::vector<std::uint32_t> edits;  ///< that pin anything in this brick, ascending
    std::int64_t last_revision = 0;    ///< of any of them
  };

  void refresh(BrickIndex index, const History& history, BrickSet& touched);
  [[nodiscard]] const PinBrick& pins_of(std::uint32_t edit, BrickIndex index) const;

  std::deque<Kept> edits_;  ///< in the order in which they were made
  std::map<std::string, std::uint32_t, std::less<>> by_id_;
  std::unordered_map<BrickIndex, History, IndexHash> by_brick_;
  PinMap pins_;
};

}  // namespace concord
