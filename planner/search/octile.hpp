#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "planner/lattice/cell.hpp"

namespace concord {

/// Costs are whole numbers, so that sums do not depend on their order. The ratio is a convergent of sqrt(2): it orders
/// paths as their true lengths do as long as they have fewer than 400,000 diagonal steps.
inline constexpr std::int64_t kStraight = 470832;
inline constexpr std::int64_t kDiagonal = 665857;

/// The cost of the shortest path over open cells in eight directions.
[[nodiscard]] inline std::int64_t octile(std::int64_t dx, std::int64_t dy) {
  dx = std::abs(dx);
  dy = std::abs(dy);
  // Two products, no branch: the smaller side is walked diagonally.
  return std::max(dx, dy) * kStraight + std::min(dx, dy) * (kDiagonal - kStraight);
}
[[nodiscard]] inline std::int64_t octile(Cell a, Cell b) {
  return octile(std::int64_t{a.x} - b.x, std::int64_t{a.y} - b.y);
}

}  // namespace concord
