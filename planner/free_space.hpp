#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "planner/grid.hpp"

namespace concord {

/// Two discs closer than this touch: a millionth of a cell, far above the rounding of positions.
inline constexpr double kTouch = 1e-6;

/// Where a round robot may be, worked out as far as it is asked about. Blocked are occupied and unknown cells alike;
/// everything outside the grid is unknown. All positions here are in cells: cell (x, y) covers [x, x + 1) x [y, y + 1).
/// Holds a reference to the grid, which must not change meanwhile.
class FreeSpace {
 public:
  static constexpr int kSide = 64;
  /// 64 x 64 cells, a word per row, bit x.
  using Rows = std::array<std::uint64_t, kSide>;

  /// `radius` in cells, finite and not negative.
  FreeSpace(const Grid& grid, double radius);

  /// The cells of one tile at whose centre the robot's disc overlaps no blocked cell.
  [[nodiscard]] const Rows& open_rows(Cell tile);
  [[nodiscard]] bool is_open(Cell cell);

  /// Whether the disc, moved in a straight line, overlaps no blocked cell. Exact; with radius 0 the line may not even
  /// touch a blocked cell's corner.
  [[nodiscard]] bool sees(const Eigen::Vector2d& from, const Eigen::Vector2d& to);

  /// No blocked cell further away than so many rows or columns matters to a cell's being open.
  [[nodiscard]] int reach() const { return reach_; }

  [[nodiscard]] static Cell tile_of(Cell cell) { return {cell.x >> 6, cell.y >> 6}; }

 private:
  using Tiles = std::unordered_map<Cell, std::unique_ptr<const Rows>, CellHash>;

  [[nodiscard]] const Rows& free_rows(Cell tile);
  [[nodiscard]] const Rows& edge_rows(Cell tile);
  [[nodiscard]] bool row_is_free(std::int32_t y, std::int32_t first, std::int32_t last);
  void carve(Rows& open, const Rows& edges, int dx, int dy) const;

  const Grid& grid_;
  double radius_;
  int reach_;                ///< rows above and below a cell that its disc touches
  std::vector<int> widths_;  ///< a blocked cell d rows away closes the cells up to widths_[d] to its left and right
  Tiles free_, edges_, open_;
  Cell last_tile_;
  const Rows* last_rows_ = nullptr;  ///< of free_[last_tile_]
};

}  // namespace concord
