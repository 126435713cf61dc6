#pragma once

#include <vector>

#include "planner/leg.hpp"

namespace concord {

/// One height band of the map with all that robots of that height meet: its grid, the zones and robots that reach into
/// it, and what is searched for each radius.
class Level {
 public:
  explicit Level(Grid grid);
  Level(const Level&) = delete;
  Level& operator=(const Level&) = delete;

  /// What changed, for robots but `except`.
  struct Update {
    std::vector<Changed> places;
    std::string except;
  };

  /// These bricks of the map have changed. Sets `columns` to those of the grid that did.
  Update project(const BrickMap& map, std::span<const BrickIndex> touched, std::vector<BrickIndex>& columns);
  Update set_zones(std::span<const Zone> zones);
  /// Where a robot stands, map frame, metres.
  Update set_robot(const std::string& robot, const Eigen::Vector2d& p, double radius);
  Update remove_robot(const std::string& robot);
  /// From now on it is as this robot sees it: it does not stand in its own way.
  void look_as(const std::string& robot);

  [[nodiscard]] const Grid& grid() const { return grid_; }
  [[nodiscard]] const ZoneLayer& zones() const { return zones_; }
  [[nodiscard]] const RobotLayer& robots() const { return robots_; }
  [[nodiscard]] Terrain terrain() const { return {grid_, zones_, robots_}; }
  [[nodiscard]] RobotGrids& grids() { return grids_; }

 private:
  [[nodiscard]] Update moved(const std::string& robot, const std::vector<BrickIndex>& columns);

  Grid grid_;
  ZoneLayer zones_;
  RobotLayer robots_;
  RobotGrids grids_;
};

/// Anything may have changed anywhere.
inline constexpr Changed kAnything{{{-kMaxVoxel, -kMaxVoxel}, {kMaxVoxel, kMaxVoxel}}, true};
[[nodiscard]] Changed joined(const Changed& a, const Changed& b);

}  // namespace concord
