#pragma once

#include <cstdint>
#include <cstdlib>
#include <utility>

#include "planner/lattice/open_grid.hpp"

namespace concord {

/// The straight line between the centres of two cells as what it touches of each line of cells across its longer way,
/// in whole numbers: a cell is a closed square, so a line that goes over a corner touches all four cells there.
struct LineOfCells {
  LineOfCells(Cell from, Cell to)
      : start(from),
        along_x(std::abs(to.x - from.x) >= std::abs(to.y - from.y)),
        sign_x(to.x >= from.x ? 1 : -1),
        sign_y(to.y >= from.y ? 1 : -1),
        run(along_x ? std::abs(to.x - from.x) : std::abs(to.y - from.y)),
        rise(along_x ? std::abs(to.y - from.y) : std::abs(to.x - from.x)) {}

  /// Calls `take(i, first, last)` for each of the rise + 1 lines of cells until it returns false: cells first to last,
  /// counted from the start's along the longer way. Returns whether it never did.
  template <class Take>
  bool for_each_span(Take take) const {
    std::int64_t first = 0;
    for (std::int64_t i = 0; i < rise; ++i) {
      // Between lines i and i + 1 it is (2 i + 1) run / (2 rise) along; cell k covers k - 1/2 to k + 1/2.
      const std::int64_t border = (2 * i + 1) * run;
      if (!take(static_cast<int>(i), static_cast<int>(first), static_cast<int>((border + rise) / (2 * rise)))) {
        return false;
      }
      first = border <= rise ? 0 : (border - rise + 2 * rise - 1) / (2 * rise);
    }
    return take(static_cast<int>(rise), static_cast<int>(first), static_cast<int>(run));
  }

  /// Calls `take(Cell)` for each cell that the line touches.
  template <class Take>
  void for_each_cell(Take take) const {
    for_each_span([&](int i, int first, int last) {
      for (int k = first; k <= last; ++k) {
        take(along_x ? Cell{start.x + sign_x * k, start.y + sign_y * i}
                     : Cell{start.x + sign_x * i, start.y + sign_y * k});
      }
      return true;
    });
  }

  Cell start;
  bool along_x;  ///< the longer way
  int sign_x, sign_y;
  std::int64_t run, rise;  ///< cells along the longer and the shorter way
};

/// Whether that line touches open cells only. Exact, and the same both ways.
[[nodiscard]] bool sees(const OpenGrid& grid, Cell from, Cell to);

}  // namespace concord
