#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "planner/footprint/footprint.hpp"
#include "planner/footprint/pose.hpp"
#include "planner/lattice/open_grid.hpp"

namespace concord {

/// What a path between poses is held against. Metres from the grid's lower left corner.
struct PoseTerms {
  const OpenGrid& grid;
  double resolution;
  const Footprint& footprint;
  double turn_radius;  ///< 0: turns in place
  Pose start, goal;    ///< as they were asked for
};

/// The validator, by other means than the search: at samples so close together that no point of the footprint moves
/// more than an eighth of a cell between two, every blocked cell near the footprint is held against its outline, one by
/// one. From pose to pose the reference point goes straight and the yaw changes evenly, the shorter way round. Besides:
/// the path begins at the start and ends at the goal exactly, goes where the robot points, and turns no tighter than it
/// may. Returns what is wrong with the path; nothing if it stands.
[[nodiscard]] std::optional<std::string> fault_of(const PoseTerms& terms, std::span<const Pose> poses);

/// Distances from the footprint's outline to the nearest blocked square, as far as `reach` metres.
struct PoseClearance {
  std::vector<double> at;  ///< by pose
  double least = 0;        ///< all along, to half a cell
};
[[nodiscard]] PoseClearance clearance_of(const PoseTerms& terms, std::span<const Pose> poses, double reach);

}  // namespace concord
