#pragma once

#include <cstdint>
#include <deque>

#include "core/error.hpp"
#include "core/transform.hpp"

namespace concord {

/// A robot's poses of the last 30 s in one frame, to tell where it was when somebody saw it.
class PoseRing {
 public:
  static constexpr std::int64_t kSpan = 30'000'000;
  /// Poses nearer in time than this to the one before are left out, which bounds the ring.
  static constexpr std::int64_t kLeastStep = 10'000;
  /// A stamp may lie so far outside of them.
  static constexpr std::int64_t kTolerance = 200'000;
  /// Far from where sums of times would overflow.
  static constexpr std::int64_t kLatest = std::int64_t{1} << 62;

  /// A stamp that is not newer than the last begins anew: the robot's clock went back. Refused (kBadRequest), and
  /// nothing has changed: a time before 1970 or after kLatest.
  [[nodiscard]] Result<void> add(std::int64_t utime, const Transform& T_agent_base);
  void clear() { poses_.clear(); }

  /// Between two poses: the translation linear, the rotation along the shortest way. Refused: further than kTolerance
  /// from all of them (kStale), whatever the time.
  [[nodiscard]] Result<Transform> at(std::int64_t utime) const;

 private:
  struct Stamped {
    std::int64_t utime;
    Transform T_agent_base;
  };
  std::deque<Stamped> poses_;  ///< in the order of time
};

}  // namespace concord
