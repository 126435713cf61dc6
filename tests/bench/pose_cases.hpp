#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planner/footprint/footprint.hpp"
#include "planner/footprint/pose.hpp"
#include "planner/lattice/open_grid.hpp"

namespace concord {

/// A building and poses in it where a robot of 1.2 x 0.8 m has room, metres from the grid's corner.
struct PoseCase {
  struct Query {
    Pose start, goal;
  };

  std::string name;
  OpenGrid grid;
  double resolution;
  std::vector<Query> queries;
};

[[nodiscard]] Footprint pose_case_robot();

/// depot, warehouse, and the warehouse with its keep-out zones, of `data`/buildings; `count` queries of each, spread
/// over those of buildings_conf, with yaws that change from one to the next. What has not been observed is blocked.
/// Throws what cannot be read.
[[nodiscard]] std::vector<PoseCase> pose_cases(const std::filesystem::path& data, std::size_t count);

}  // namespace concord
