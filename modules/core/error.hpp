#pragma once

#include <string>
#include <tl/expected.hpp>

namespace concord {

/// Why something from outside was refused. The names travel in `answer_t::code` and in status counters.
enum class Code {
  kMalformed,     ///< bytes that are not what they claim to be
  kTooLarge,      ///< over a stated limit
  kNotFinite,     ///< NaN or infinity where a number is needed
  kBadTransform,  ///< not a rotation and a translation within the map's bounds
  kBadFrame,      ///< a frame that is unknown, over, or not the one expected
  kBadResolution,
  kBadName,  ///< a name that is not on the whitelist for ids and files
  kBadRequest,
  kBadShape,  ///< a line, area or volume that encloses nothing or crosses itself
  kOutOfBounds,
  kEmpty,
  kStale,
  kStaleRevision,  ///< it was changed since the revision that the asker saw
  kLocked,         ///< somebody else holds the region
  kNotAligned,     ///< the agent's place in the map is not known
  kCollision,      ///< what is moved would meet what is there
  kConflict,       ///< it is so already, or was undone
  kNoAgent,
  kNoMap,
  kNotFound,
  kExists,
  kLowScore,  ///< what was seen is too uncertain
  kExpired,   ///< it held for a while only, or was withdrawn
  kBusy,      ///< not now; ask again
  kIo,
};

/// The stable wire name of a code, e.g. "TOO_LARGE".
[[nodiscard]] const char* name(Code code);

/// A refusal: what went wrong and what to do about it.
struct Error {
  Code code;
  std::string message;
};

template <class T>
using Result = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> refuse(Code code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

}  // namespace concord
