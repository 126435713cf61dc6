#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "planner/terrain.hpp"

namespace concord {

/// Two discs closer than this touch: a millionth of a cell, far above the rounding of positions.
inline constexpr double kTouch = 1e-6;

/// Between exact points and cells; positions in cells.
[[nodiscard]] Cell cell_of(const Eigen::Vector2d& p);
[[nodiscard]] Eigen::Vector2d centre_of(Cell cell);

/// Where a round robot may be, worked out as far as it is asked about. Its centre stays in passable cells, its body
/// over touchable ones (`Ground`); occupied and unknown cells are alike, and everything outside the grid is unknown.
/// All positions here are in cells: cell (x, y) covers [x, x + 1) x [y, y + 1).
/// The terrain must outlive it, and change only along with `follow`.
class FreeSpace {
 public:
  static constexpr int kSide = 64;
  /// 64 x 64 cells, a word per row, bit x.
  using Rows = std::array<std::uint64_t, kSide>;

  /// `radius` in cells, finite and not negative.
  FreeSpace(const Terrain& terrain, double radius);

  /// The ground of this column of bricks has changed.
  void follow(BrickIndex column);

  /// The passable cells of one tile at whose centre the robot's disc overlaps touchable cells only.
  [[nodiscard]] const Rows& open_rows(Cell tile);
  [[nodiscard]] bool is_open(Cell cell);

  /// Whether the disc, moved in a straight line, overlaps touchable cells only, and the line touches only passable
  /// ones, be it at a corner. Exact.
  [[nodiscard]] bool sees(const Eigen::Vector2d& from, const Eigen::Vector2d& to);

  /// No blocked cell further away than so many rows or columns matters to a cell's being open.
  [[nodiscard]] int reach() const { return reach_; }

  [[nodiscard]] static Cell tile_of(Cell cell) { return {cell.x >> 6, cell.y >> 6}; }

 private:
  using Tiles = std::unordered_map<Cell, std::unique_ptr<Rows>, CellHash>;

  /// One plane of `Ground`, by tiles.
  struct Layer {
    std::uint64_t Ground::*plane;
    Tiles tiles;
    Cell last_tile;
    const Rows* last_rows = nullptr;  ///< of tiles[last_tile]
  };

  static void put(Rows& rows, BrickIndex column, std::uint64_t plane);
  [[nodiscard]] const Rows& rows(Layer& layer, Cell tile);
  [[nodiscard]] const Rows& edge_rows(Cell tile);
  [[nodiscard]] bool has_row(Layer& layer, std::int32_t y, std::int32_t first, std::int32_t last);
  [[nodiscard]] bool covers(Layer& layer, const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius);
  void carve(Rows& open, const Rows& edges, int dx, int dy) const;

  Terrain terrain_;
  double radius_;
  int reach_;                ///< rows above and below a cell that its disc touches
  std::vector<int> widths_;  ///< a blocked cell d rows away closes the cells up to widths_[d] to its left and right
  Layer touchable_{&Ground::touchable, {}, {}, nullptr};
  Layer passable_{&Ground::passable, {}, {}, nullptr};  ///< unused without allow-contact zones: it is the same then
  Tiles edges_, open_;
};

}  // namespace concord
