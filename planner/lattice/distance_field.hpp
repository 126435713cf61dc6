#pragma once

#include <cstdint>
#include <vector>

#include "planner/lattice/open_grid.hpp"

namespace concord {

/// For every cell the squared distance to the nearest blocked one, centre to centre in cells, as far as `reach`; the
/// border around the grid is blocked. Exact (Meijster, Roerdink & Hesselink 2000), in whole numbers; after a change the
/// same as if it were worked out anew.
class DistanceField {
 public:
  static constexpr int kMaxReach = 255;

  /// Takes the grid as it is now. It must outlive this and change only along with `update`. @pre 1 <= reach <=
  /// kMaxReach.
  DistanceField(const OpenGrid& grid, int reach);

  /// Cells in `window` have changed. Costs the cells within `reach` of it.
  void update(const Window& window);

  [[nodiscard]] int reach() const { return reach_; }
  /// 0 at a blocked cell; reach squared where nothing blocked is nearer. @pre the grid holds the cell.
  [[nodiscard]] std::uint16_t squared(Cell cell) const { return squared_[index_of(cell)]; }
  [[nodiscard]] const std::uint16_t* row(int y) const { return squared_.data() + index_of({0, y}); }

 private:
  [[nodiscard]] std::size_t index_of(Cell cell) const {
    return static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(grid_.width()) +
           static_cast<std::size_t>(cell.x);
  }
  void find_heights(int x0, int x1, int y0, int y1);
  void find_row(int y, int x0, int x1);

  const OpenGrid& grid_;
  int reach_;
  std::vector<std::uint8_t> heights_;  ///< to the nearest blocked cell of the same column, at most reach
  std::vector<std::uint16_t> squared_;
  /// The lower envelope of one row's parabolas: where each is lowest from, and whose it is.
  std::vector<int> from_, column_;
};

}  // namespace concord
