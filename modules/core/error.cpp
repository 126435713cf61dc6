#include "core/error.hpp"

namespace concord {

const char* name(Code code) {
  switch (code) {
    case Code::kMalformed: return "MALFORMED";
    case Code::kTooLarge: return "TOO_LARGE";
    case Code::kNotFinite: return "NOT_FINITE";
    case Code::kBadTransform: return "BAD_TRANSFORM";
    case Code::kBadFrame: return "BAD_FRAME";
    case Code::kBadResolution: return "RES_MISMATCH";
    case Code::kBadName: return "BAD_NAME";
    case Code::kBadRequest: return "BAD_REQUEST";
    case Code::kBadShape: return "BAD_SHAPE";
    case Code::kOutOfBounds: return "OUT_OF_BOUNDS";
    case Code::kEmpty: return "EMPTY";
    case Code::kStale: return "STALE";
    case Code::kStaleRevision: return "STALE_REV";
    case Code::kLocked: return "LOCKED";
    case Code::kNotAligned: return "NOT_ALIGNED";
    case Code::kCollision: return "COLLISION";
    case Code::kConflict: return "CONFLICT";
    case Code::kNoAgent: return "NO_AGENT";
    case Code::kNoMap: return "NO_MAP";
    case Code::kNotFound: return "NOT_FOUND";
    case Code::kExists: return "EXISTS";
    case Code::kLowScore: return "LOW_SCORE";
    case Code::kExpired: return "EXPIRED";
    case Code::kBusy: return "BUSY";
    case Code::kIo: return "IO";
  }
  return "UNKNOWN";
}

}  // namespace concord
