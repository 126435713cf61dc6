#pragma once

#include <cstdint>
#include <map>
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
  /// Pins the edit's voxels and adds their bricks to `touched`. @pre find(edit.id) is null.
  void apply(const EditRequest& edit, BrickSet& touched);

  struct Applied {
    std::int64_t revision = 0;  ///< that it led to
    std::uint64_t content = 0;  ///< see content()
  };
  /// Null if no edit of this id was applied.
  [[nodiscard]] const Applied* find(const std::string& edit_id) const;
  /// Of what the edit pins: tells edits of one id apart.
  [[nodiscard]] static std::uint64_t content(const EditRequest& edit);
  /// Counts up by one with each edit, from 0.
  [[nodiscard]] std::int64_t revision() const { return revision_; }
  [[nodiscard]] const PinMap& pins() const { return pins_; }

 private:
  PinMap pins_;
  std::map<std::string, Applied> applied_;
  std::int64_t revision_ = 0;
};

}  // namespace concord
