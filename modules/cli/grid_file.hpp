#pragma once

#include <filesystem>

#include "planner/grid.hpp"

namespace concord {

/// The cells of a grid that are known, and how many there are of each kind.
struct GridExtent {
  Cell min, max;  ///< both included
  std::int64_t free = 0, occupied = 0;

  [[nodiscard]] std::int64_t width() const { return std::int64_t{max.x} - min.x + 1; }
  [[nodiscard]] std::int64_t height() const { return std::int64_t{max.y} - min.y + 1; }
};

/// Refused: a grid without a known cell (kEmpty).
[[nodiscard]] Result<GridExtent> extent_of(const Grid& grid);

/// The grid as ROS's map_server reads it: `pgm`, and a .yaml of the same name beside it.
/// Refused: a picture of over 100 million cells (kTooLarge), a name that does not end in .pgm (kBadName), kIo.
[[nodiscard]] Result<void> save_grid(const std::filesystem::path& pgm, const Grid& grid, const GridExtent& extent);

/// What map_server's files hold. Cells lie in a frame of their own, whose corner is at `origin`.
struct LoadedGrid {
  Grid grid;
  BrickMap cells;  ///< voxels with z = 0
  Eigen::Vector2d origin;
};
/// Refused: see read_map_server_yaml and read_map_server_pgm; kNotFound, kIo.
[[nodiscard]] Result<LoadedGrid> load_grid(const std::filesystem::path& yaml);

/// The whole map projected. Refused: see make_band.
[[nodiscard]] Result<Grid> project_map(const BrickMap& map, double resolution, double zmin, double zmax,
                                       double free_share);

}  // namespace concord
