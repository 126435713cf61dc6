#include "planner/reason.hpp"

namespace concord {

const char* name(Reason reason) {
  switch (reason) {
    case Reason::kOk: return "OK";
    case Reason::kBadRequest: return "BAD_REQUEST";
    case Reason::kNoMap: return "NO_MAP";
    case Reason::kNoPose: return "NO_POSE";
    case Reason::kNoZones: return "NO_ZONES";
    case Reason::kStartOutsideMap: return "START_OUTSIDE_MAP";
    case Reason::kGoalOutsideMap: return "GOAL_OUTSIDE_MAP";
    case Reason::kStartInNoGo: return "START_IN_NO_GO";
    case Reason::kGoalInNoGo: return "GOAL_IN_NO_GO";
    case Reason::kStartOccupied: return "START_OCCUPIED";
    case Reason::kGoalOccupied: return "GOAL_OCCUPIED";
    case Reason::kStartUnknown: return "START_UNKNOWN";
    case Reason::kGoalUnknown: return "GOAL_UNKNOWN";
    case Reason::kStartClearance: return "START_CLEARANCE";
    case Reason::kGoalClearance: return "GOAL_CLEARANCE";
    case Reason::kNoValidPath: return "NO_VALID_PATH";
    case Reason::kWaypointUnreachable: return "WAYPOINT_UNREACHABLE";
    case Reason::kBlockedByEdit: return "BLOCKED_BY_EDIT";
    case Reason::kBlockedByUnknown: return "BLOCKED_BY_UNKNOWN";
    case Reason::kBusy: return "BUSY";
    case Reason::kMapStale: return "MAP_STALE";
    case Reason::kCancelled: return "CANCELLED";
    case Reason::kSearchLimit: return "SEARCH_LIMIT";
    case Reason::kValidationFailed: return "VALIDATION_FAILED";
  }
  return "BAD_REQUEST";
}

}  // namespace concord
