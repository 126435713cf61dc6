#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "planner/grid.hpp"

namespace concord::test {

/// A map one voxel high and its grid: '#' occupied, '.' free, anything else unknown. Row 0 is y = `origin.y`.
inline Grid sketch(const std::vector<std::string>& rows, Cell origin = {}, double resolution = 1.0) {
  BrickMap map;
  for (std::size_t y = 0; y < rows.size(); ++y) {
    for (std::size_t x = 0; x < rows[y].size(); ++x) {
      const char c = rows[y][x];
      if (c != '#' && c != '.') continue;
      const VoxelIndex voxel{origin.x + static_cast<std::int32_t>(x), origin.y + static_cast<std::int32_t>(y), 0};
      const Brick* old = map.find(brick_of(voxel));
      DenseBrick dense;
      (old != nullptr ? *old : Brick()).to_dense(dense);
      dense[concord::local_of(voxel)] = c == '#' ? kOccupied : kFree;
      map.set(brick_of(voxel), Brick::from_dense(dense));
    }
  }
  Grid grid(resolution, make_band(0, resolution, resolution).value(), 0.5);
  grid.update(map, map.sorted_bricks());
  return grid;
}

/// Free cells with a share of obstacles and unknown ones strewn in.
inline std::vector<std::string> strewn(std::mt19937& random, int width, int height, double occupied, double unknown) {
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<std::string> rows(height, std::string(width, '.'));
  for (std::string& row : rows) {
    for (char& c : row) {
      const double u = share(random);
      c = u < occupied ? '#' : u < occupied + unknown ? ' ' : '.';
    }
  }
  return rows;
}

/// Distance of a point to the closed square of a cell; all in cells.
inline double distance(double x, double y, Cell cell) {
  const double dx = std::max({cell.x - x, 0.0, x - cell.x - 1});
  const double dy = std::max({cell.y - y, 0.0, y - cell.y - 1});
  return std::sqrt(dx * dx + dy * dy);
}

/// Distance of a point to the nearest cell that is not free, looked for one by one up to `reach`; all in cells.
inline double nearest_blocked(const Grid& grid, double x, double y, double reach) {
  double least = reach;
  const auto r = static_cast<int>(std::ceil(reach)) + 1;
  const auto cx = static_cast<std::int32_t>(std::floor(x));
  const auto cy = static_cast<std::int32_t>(std::floor(y));
  for (std::int32_t j = cy - r; j <= cy + r; ++j) {
    for (std::int32_t i = cx - r; i <= cx + r; ++i) {
      if (!is_free(grid.at({i, j}))) least = std::min(least, distance(x, y, {i, j}));
    }
  }
  return least;
}

}  // namespace concord::test
