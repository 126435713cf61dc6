#pragma once

#include <vector>

#include "planner/footprint/standing_room.hpp"
#include "planner/lattice/cell.hpp"

namespace concord {

/// Poses beside a path of cells that a robot may come by, in its order.
struct Guide {
  std::vector<std::vector<Pose>> stops;  ///< the first is the start alone, the last the goal alone
  std::vector<double> left;              ///< by stop: cells along the path to the goal
};

/// How close together the poses are.
struct GuideDensity {
  double spacing;  ///< of the stops, in radii of the footprint's outer disc
  int yaws;        ///< at each stop at least these, evenly around, where there is room
};

/// Stops along `cells`, each with the poses that have room there: along the path, against it, and the middle of every
/// range of yaws that has room, since where only a few have, they are the ones that fit through. From such a narrow
/// place also the poses straight ahead of it and behind it, from which it can be driven into without a turn.
[[nodiscard]] Guide make_guide(const StandingRoom& room, const std::vector<Cell>& cells, const Pose& start,
                               const Pose& goal, const GuideDensity& density);

}  // namespace concord
