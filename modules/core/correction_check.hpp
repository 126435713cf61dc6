#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include "core/corrections.hpp"
#include "core/error.hpp"

namespace concord {

/// Of one edit that is stored: the first release let more through than kMaxEditVoxels, and what it kept stays.
inline constexpr std::int64_t kMaxStoredEditVoxels = 1'000'000;
/// Of all edits, undone ones included: what a map file may hold (kMaxArchivePins).
inline constexpr std::int64_t kMaxPins = 100'000'000;

/// Whether corrections from outside are ones, and may follow one another: what every request that was granted has led
/// to in its turn, asked of a list as a whole before anything is changed by it.
class CorrectionCheck {
 public:
  /// The next of the list. Refused, and not taken: a revision that is not above the last one's (kStale); an id that was
  /// there (kExists); an id, author or name that is none (kBadName); voxels not sorted, not unique, both added and
  /// deleted, or not what the op leads to, a weight that is none (kBadRequest), out of bounds (kOutOfBounds), too many
  /// (kTooLarge, over kMaxStoredEditVoxels or kMaxPins in all) or none (kEmpty); a transform that is none or beyond 10
  /// km (kNotFinite, kBadTransform); what `check` refuses of a volume; undoing or redoing an edit that is not there
  /// (kNotFound) or is so already (kConflict); adding a zone whose name is taken (kExists), changing or deleting one
  /// that is not there (kNotFound), more than kMaxZones at a time (kTooLarge). Of a zone's author, time and revision
  /// nothing is asked.
  [[nodiscard]] Result<void> take(const Correction& correction);

 private:
  struct Follow;

  std::int64_t revision_ = 0;
  std::int64_t pins_ = 0;
  std::unordered_set<std::string> ids_;
  std::unordered_map<std::string, bool> edits_;  ///< id, whether it stands
  std::unordered_set<std::string> zones_;
};

}  // namespace concord
