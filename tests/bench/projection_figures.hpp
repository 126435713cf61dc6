#pragma once

#include <cstddef>
#include <vector>

namespace concord {

/// What bringing the planner's grid up to date takes.
struct ProjectionFigures {
  std::size_t map_voxels = 0, map_columns = 0;
  std::vector<double> edit_us;   ///< of an edit of 10 x 1 x 20 voxels
  std::size_t edit_columns = 0;  ///< that the last one touched
  std::vector<double> scan_us;   ///< of the same band by a scan over the leaves of an OctoMap
  std::size_t agent_columns = 0;
  double agent_us = 0;          ///< of a submap that comes to the map
  double whole_us = 0;          ///< of the map, from nothing
  std::size_t wrong_cells = 0;  ///< in which the grid and the scan differ
};

/// On a floor of offices of two million known voxels at 5 cm, walls and what is free between them.
[[nodiscard]] ProjectionFigures projection_figures();

}  // namespace concord
