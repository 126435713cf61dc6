#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "planner/lattice/open_grid.hpp"

namespace concord {

/// Which corners can be seen from a cell's centre: cells with a blocked cell at one of their own corners and open ones
/// beside it, where a taut path turns. Found row by row, as slopes between what blocks the view; exact, in whole
/// numbers.
class CornerSight {
 public:
  /// Two of the four signs name a quadrant: columns towards +x or -x, rows towards +y or -y.
  struct Quadrant {
    int x, y;
  };
  /// Slopes dx / dy within a quadrant, both counted away from the eye; not including the ends.
  struct Slope {
    std::int64_t dx, dy;  ///< dy >= 0; dy = 0 is along the row

    [[nodiscard]] bool operator<(const Slope& other) const { return dx * other.dy < other.dx * dy; }
  };
  /// Just below straight up or down, just above straight left or right: for a whole quadrant.
  static constexpr Slope kSteepest{-1, 1 << 20};
  static constexpr Slope kFlattest{1, 0};

  /// Takes the grid as it is now. It must outlive this and change only along with `update`.
  explicit CornerSight(const OpenGrid& grid);
  void update(const Window& window);

  /// Appends the corners in sight. What lies along the row of the eye belongs to a view that reaches to kFlattest.
  void look(Cell eye, Quadrant quadrant, Slope low, Slope high, std::vector<Cell>& seen);

  /// Whether the cell has a blocked cell at its corner towards (x, y), each +1 or -1, and open ones beside that.
  [[nodiscard]] bool is_corner(Cell cell, int x, int y) const;

 private:
  struct Interval {
    Slope low, high;
  };

  void find_row(int y);
  [[nodiscard]] int distance_to(const BitLines& lines, int line, int bit, int sign) const;
  void take(Cell eye, Quadrant quadrant, std::int64_t row, const Interval& view, std::vector<Cell>& seen) const;
  void narrow(Cell eye, Quadrant quadrant, std::int64_t row, const Interval& view);

  const OpenGrid& grid_;
  BitLines blocked_, corners_;
  std::vector<Interval> views_, next_;  ///< in one row and the one after it
};

}  // namespace concord
