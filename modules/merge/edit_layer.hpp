#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/brick_set.hpp"
#include "core/pins.hpp"
#include "core/requests.hpp"

namespace concord {

/// What people corrected: explicit pins in the map frame, the latest edit winning in its voxels. They stand above
/// every sensor and outlive every re-alignment, because they are kept apart from the agents' layers.
class EditLayer {
 public:
  /// Pins the edit's voxels and adds their bricks to `touched`. @pre revision_of(edit.id) is empty.
  void apply(const EditRequest& edit, BrickSet& touched);

  /// The revision that an edit led to; empty if it was never applied.
  [[nodiscard]] std::optional<std::int64_t> revision_of(const std::string& edit_id) const;
  /// Counts up by one with each edit, from 0.
  [[nodiscard]] std::int64_t revision() const { return revision_; }
  [[nodiscard]] const PinMap& pins() const { return pins_; }

 private:
  PinMap pins_;
  std::map<std::string, std::int64_t> revisions_;
  std::int64_t revision_ = 0;
};

}  // namespace concord
