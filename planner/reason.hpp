#pragma once

namespace concord {

/// Why there is no path; the names in README.md travel in `Path::status`.
enum class Reason {
  kOk,
  kBadRequest,
  kNoMap,
  kNoPose,
  kNoZones,
  kStartOutsideMap,
  kGoalOutsideMap,
  kStartInNoGo,
  kGoalInNoGo,
  kStartOccupied,
  kGoalOccupied,
  kStartUnknown,
  kGoalUnknown,
  kStartClearance,
  kGoalClearance,
  kNoValidPath,
  kWaypointUnreachable,
  kBlockedByEdit,
  kBlockedByUnknown,
  kBusy,
  kMapStale,
  kCancelled,
  kSearchLimit,
  kValidationFailed,
};

/// E.g. "START_OCCUPIED".
[[nodiscard]] const char* name(Reason reason);

}  // namespace concord
