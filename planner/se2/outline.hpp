#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "planner/footprint/pose.hpp"
#include "planner/lattice/open_grid.hpp"

namespace concord {

/// A footprint's outline where it stands, in cells: what the validator holds blocked cells against. Of its own
/// geometry, apart from that of the search.
class Outline {
 public:
  /// `polygon` in metres, `pose` in metres from the grid's corner.
  Outline(std::span<const Eigen::Vector2d> polygon, const Pose& pose, double resolution);

  /// Whether the area overlaps the square of a cell, by more than `touch` cells.
  [[nodiscard]] bool overlaps(Cell cell, double touch) const;
  /// From the area to the square of a cell, in cells.
  [[nodiscard]] double distance(Cell cell) const;

  /// Calls `take(cell)` for each blocked cell whose square lies within `reach` of the box around it, until it says no;
  /// cells just beyond the grid are blocked, those further away are nothing.
  template <class Take>
  void for_each_blocked(const OpenGrid& grid, double reach, Take take) const {
    const int x0 = std::max(-1, static_cast<int>(std::floor(low_.x() - reach)));
    const int x1 = std::min(grid.width(), static_cast<int>(std::floor(high_.x() + reach)));
    const int y0 = std::max(-1, static_cast<int>(std::floor(low_.y() - reach)));
    const int y1 = std::min(grid.height(), static_cast<int>(std::floor(high_.y() + reach)));
    for (int y = y0; y <= y1; ++y) {
      const std::uint64_t* words = grid.rows().line(y + 1);
      for (int bit = x0 + 1; bit <= x1 + 1; ++bit) {
        if ((words[bit >> 6] >> (bit & 63) & 1) != 0) {
          // All of a word's open cells at a time.
          if (words[bit >> 6] == ~std::uint64_t{0}) bit |= 63;
          continue;
        }
        if (!take(Cell{bit - 1, y})) return;
      }
    }
  }

 private:
  [[nodiscard]] bool holds(const Eigen::Vector2d& p) const;

  std::vector<Eigen::Vector2d> corners_;
  Eigen::Vector2d low_, high_;
};

}  // namespace concord
