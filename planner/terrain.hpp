#pragma once

#include <cstdint>

#include "planner/grid.hpp"
#include "planner/robot_layer.hpp"
#include "planner/zone_layer.hpp"

namespace concord {

/// What the cells of a column of bricks are to a robot; bit x + 8 y.
struct Ground {
  std::uint64_t free = 0;       ///< as the grid says
  std::uint64_t passable = 0;   ///< its centre may be there: free, in no no-go zone, and no other robot stands there
  std::uint64_t touchable = 0;  ///< its body may be over it: passable, or contact is allowed and no no-go zone there
};

/// What is taken as if it were free, to tell what closes a way.
enum class Ignoring {
  kNothing,
  kRobots,      ///< other robots do not stand there
  kNoGo,        ///< there are no no-go zones
  kPins,        ///< what only edits made occupied
  kUnobserved,  ///< what nobody has seen, within the rectangle around all that is known
};

/// The layers that robots move on, each kept apart: what was observed, what people pinned, where they forbade to go,
/// where robots stand.
/// Holds pointers to all of them.
class Terrain {
 public:
  // NOLINTNEXTLINE(google-explicit-constructor): a grid alone is ground enough
  Terrain(const Grid& grid, const ZoneLayer& zones = no_zones(), const RobotLayer& robots = no_robots(),
          Ignoring ignoring = Ignoring::kNothing)
      : grid_(&grid), zones_(&zones), robots_(&robots), ignoring_(ignoring) {}

  [[nodiscard]] Terrain without(Ignoring what) const { return {*grid_, *zones_, *robots_, what}; }
  [[nodiscard]] Ground at(BrickIndex column) const;

  [[nodiscard]] const Grid& grid() const { return *grid_; }
  [[nodiscard]] const ZoneLayer& zones() const { return *zones_; }
  [[nodiscard]] const RobotLayer& robots() const { return *robots_; }
  [[nodiscard]] double resolution() const { return grid_->resolution(); }
  [[nodiscard]] bool has_contact() const { return zones_->has_contact(); }

 private:
  [[nodiscard]] std::uint64_t free_at(BrickIndex column) const;

  const Grid* grid_;
  const ZoneLayer* zones_;
  const RobotLayer* robots_;
  Ignoring ignoring_;
};

}  // namespace concord
