#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/brick_set.hpp"
#include "core/error.hpp"
#include "core/pins.hpp"

namespace concord {

/// One correction by a person, evaluated once: the voxels that it pins, in the map frame.
struct Edit {
  std::string id;
  std::string author;
  std::int64_t utime = 0;
  std::vector<VoxelIndex> added;    ///< sorted, unique
  std::vector<VoxelIndex> deleted;  ///< sorted, unique, none of them in `added`
};

/// What people corrected. The pins are a function of which edits are active: the latest active edit wins in its voxels,
/// by the order in which edits were first made. So undo and redo work in any order, and undoing all shows what the
/// sensors say. Edits stand above every sensor and outlive re-alignment, because they are kept apart from the layers.
class EditLayer {
 public:
  /// Adds the bricks whose pins change to `touched`. @pre no edit of this id was made.
  void apply(const Edit& edit, BrickSet& touched);

  /// Takes an edit back, or brings it back. Refused: kNotFound; kConflict if it is undone, or active, already.
  [[nodiscard]] Result<void> undo(const std::string& edit_id, BrickSet& touched);
  [[nodiscard]] Result<void> redo(const std::string& edit_id, BrickSet& touched);

  [[nodiscard]] bool contains(const std::string& edit_id) const { return by_id_.contains(edit_id); }
  /// @pre contains(edit_id).
  [[nodiscard]] bool is_active(const std::string& edit_id) const { return edits_[by_id_.at(edit_id)].active; }
  [[nodiscard]] const PinMap& pins() const { return pins_; }

 private:
  struct Kept {
    std::vector<std::pair<BrickIndex, PinBrick>> bricks;
    bool active = true;
  };

  [[nodiscard]] Result<void> activate(const std::string& edit_id, bool active, BrickSet& touched);
  void refresh(BrickIndex index, BrickSet& touched);
  [[nodiscard]] const PinBrick& pins_of(std::uint32_t edit, BrickIndex index) const;

  std::vector<Kept> edits_;  ///< in the order in which they were made
  std::map<std::string, std::uint32_t> by_id_;
  std::unordered_map<BrickIndex, std::vector<std::uint32_t>, IndexHash> by_brick_;  ///< ascending
  PinMap pins_;
};

}  // namespace concord
