#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace concord {

/// Occupancy of one voxel as log-odds in units of 1/1024; `kUnknown` where nothing was observed.
using LogOdds = std::int16_t;

inline constexpr LogOdds kUnknown = -32768;
inline constexpr double kLogOddsScale = 1024.0;

/// What a binary map says: log-odds -2.0 and +3.5, OctoMap's clamping thresholds.
inline constexpr LogOdds kFree = -2048;
inline constexpr LogOdds kOccupied = 3584;

/// What a person pinned: the ends of the range, which no sensor value outranks.
inline constexpr LogOdds kPinnedFree = -32767;
inline constexpr LogOdds kPinnedOccupied = 32767;

/// Two layers conflict in a voxel when one says >= +0.4 and another <= -0.4 (log-odds).
inline constexpr LogOdds kConflictOccupied = 410;
inline constexpr LogOdds kConflictFree = -410;

[[nodiscard]] constexpr bool is_known(LogOdds l) { return l != kUnknown; }
[[nodiscard]] constexpr bool is_occupied(LogOdds l) { return l >= 0; }
[[nodiscard]] constexpr bool is_free(LogOdds l) { return l < 0 && l != kUnknown; }

/// Saturating; never yields kUnknown. The sign survives: a value below zero never rounds up to occupied.
/// @pre `value` is finite.
[[nodiscard]] inline LogOdds to_log_odds(double value) {
  const double scaled = std::clamp(value * kLogOddsScale, -32767.0, 32767.0);
  const auto rounded = static_cast<LogOdds>(std::lround(scaled));
  return rounded == 0 && value < 0 ? LogOdds{-1} : rounded;
}

[[nodiscard]] constexpr double to_double(LogOdds l) { return l / kLogOddsScale; }

}  // namespace concord
