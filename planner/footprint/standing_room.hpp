#pragma once

#include <vector>

#include "planner/footprint/footprint.hpp"
#include "planner/footprint/pose.hpp"
#include "planner/lattice/distance_field.hpp"

namespace concord {

/// A move of a robot that steers constantly: ahead or back along a line or an arc, or a turn in place.
struct Move {
  double travel = 0;  ///< cells of its reference point, negative: back
  double turn = 0;    ///< radians, positive: to the left

  [[nodiscard]] Pose from(const Pose& start, double share = 1) const;
};

/// Where a footprint has room, standing and moving: it overlaps open cells only, with its whole area, and may touch
/// others. Poses in cells. Discs in and around it decide what they can by one look at the distance field; the rest is
/// decided by the exact area of convex hulls.
///
/// A turning move is taken in steps between which the hull of both ends, widened by kBow, holds all that the footprint
/// sweeps, whether it goes along the arc or straight from pose to pose with evenly changing yaw. So what is said to be
/// free is; what is said not to be may be free by less than kBow (sqrt 2 of it diagonally).
class StandingRoom {
 public:
  static constexpr double kBow = 0.04;  ///< cells
  static constexpr double kMostTurn = 0.1;
  static constexpr double kMostTravel = 256;

  /// Both must outlive this, `field` be kept up to date with `grid`. `footprint` in cells.
  StandingRoom(const OpenGrid& grid, const DistanceField& field, Footprint footprint);

  [[nodiscard]] const OpenGrid& grid() const { return grid_; }
  [[nodiscard]] const Footprint& footprint() const { return footprint_; }

  [[nodiscard]] bool stands(const Pose& pose) const;
  /// Whether it can make the move from there, both ends included.
  [[nodiscard]] bool moves(const Pose& start, const Move& move) const;
  /// In so many equal steps is a move taken.
  [[nodiscard]] int steps(const Move& move) const;

  /// Centre to centre, as far as the field reaches; 0 where `p` is beyond the grid.
  [[nodiscard]] double distance(const Eigen::Vector2d& p) const;

 private:
  [[nodiscard]] bool sweeps(const Pose& from, const Pose& to, double slack) const;

  const OpenGrid& grid_;
  const DistanceField& field_;
  Footprint footprint_;
};

}  // namespace concord
