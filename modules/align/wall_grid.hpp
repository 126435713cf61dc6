#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "align/align_map.hpp"

namespace concord {

/// A piece of wall seen from above.
struct WallColumn {
  Eigen::Vector2f p;  ///< metres, upright frame
  float height;       ///< metres of it that are occupied
};

/// The columns of a map on a lattice of `cell` metres, in ascending order of cells; floors and ceilings left out.
/// @pre R turns the map's frame upright.
[[nodiscard]] std::vector<WallColumn> wall_columns(const AlignMap& map, const Eigen::Matrix3d& R_upright_map,
                                                   double cell);

/// Without those that stand far off: farther from where eight in ten are, along x or y, than these are apart, and than
/// 5 m. What was seen through a door or is no wall at all would else make a room as wide as a town.
[[nodiscard]] std::vector<WallColumn> without_far(std::vector<WallColumn> walls);

/// A picture of a map from above: positive where walls stand, negative where it is open, 0 where nobody looked; with
/// the largest value of each window of 2^level x 2^level cells, for upper bounds.
class WallGrid {
 public:
  static constexpr int kWall = 120;
  static constexpr int kOpen = -100;
  static constexpr int kLevels = 6;

  /// Over 16 million cells what stands far off is left out; over that still nothing is in it.
  WallGrid(const AlignMap& map, const Eigen::Matrix3d& R_upright_map, double cell);

  /// The largest value in [x, x + 2^level) x [y, y + 2^level).
  [[nodiscard]] int at(int level, int x, int y) const {
    const int reach = (1 << level) - 1;
    const int column = x - origin_.x() + reach;
    const int row = y - origin_.y() + reach;
    const int width = size_.x() + reach;
    if (column < 0 || row < 0 || column >= width || row >= size_.y() + reach) return 0;
    return levels_[level][static_cast<std::size_t>(row) * width + column];
  }
  [[nodiscard]] const Eigen::Vector2i& origin() const { return origin_; }
  [[nodiscard]] const Eigen::Vector2i& size() const { return size_; }

 private:
  [[nodiscard]] bool frame(const std::vector<WallColumn>& walls, double cell);
  void make_levels();

  Eigen::Vector2i origin_ = Eigen::Vector2i::Zero();  // cells
  Eigen::Vector2i size_ = Eigen::Vector2i::Zero();
  std::vector<std::vector<std::int8_t>> levels_;
};

}  // namespace concord
