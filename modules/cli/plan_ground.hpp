#pragma once

#include "cli/grid_file.hpp"

namespace concord {

/// What a path is planned on: `map` is what the picture shows, `origin` where its frame lies in that of the request.
struct Ground2D {
  Grid grid;
  BrickMap map;
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
};

/// Refused: see load_grid, load_map and project_map.
[[nodiscard]] Result<Ground2D> ground_of_grid(const std::string& yaml);
[[nodiscard]] Result<Ground2D> ground_of_map(const std::string& file, double zmin, double zmax, double free_share);

}  // namespace concord
