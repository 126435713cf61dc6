#pragma once

#include <vector>

#include "pose_cases.hpp"

namespace concord {

/// Milliseconds of this thread's processor time.
struct PoseFigures {
  std::size_t solved = 0;
  std::size_t violations = 0;  ///< paths that do not stand the validator
  double startup_ms = 0;       ///< what is worked out of the grid alone
  std::vector<double> ms;      ///< by query, without the validator
  std::vector<double> check_ms;
  std::vector<double> length;         ///< by solved query, metres
  std::vector<std::size_t> unsolved;  ///< queries
  std::size_t sampled = 0;            ///< solved by samples, not along the grid path
};

/// Every query of a building, one after the other.
[[nodiscard]] PoseFigures pose_figures(const PoseCase& c, double turn_radius);

}  // namespace concord
