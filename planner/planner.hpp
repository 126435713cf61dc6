#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/brick_map.hpp"
#include "core/requests.hpp"
#include "planner/grid.hpp"
#include "planner/plan.hpp"
#include "planner/region.hpp"
#include "planner/zone_layer.hpp"

namespace concord {

/// The planner's state: a copy of the map, its grid, the zones, where robots are, and the paths that are kept active.
/// It is told what happens and when; what it answers is to be published.
class Planner {
 public:
  static constexpr std::size_t kMaxActive = 256;  ///< robots whose path is kept active
  static constexpr std::size_t kMaxPoses = 1024;  ///< robots whose pose is kept
  static constexpr std::size_t kKeptPaths = 256;  ///< requests that are answered alike when they come again

  /// What a path is planned at.
  struct Moment {
    std::int64_t map_revision = 0;
    std::int64_t utime = 0;
  };

  explicit Planner(Grid grid) : grid_(std::move(grid)), zones_(grid_.resolution(), grid_.band()) {}

  void set_brick(BrickIndex index, Brick brick);
  void clear_map();
  /// Brings the grid up to date; finds the active paths that the change touches. Returns the columns that changed.
  std::vector<BrickIndex> project();
  [[nodiscard]] const Grid& grid() const { return grid_; }

  /// All zones that hold from now on; finds the active paths that the change touches. Before the first call there is no
  /// path: nobody knows where robots may not go.
  void set_zones(std::span<const Zone> zones);
  [[nodiscard]] const ZoneLayer& zones() const { return zones_; }

  /// Where a robot is, map frame. False if it is one robot too many.
  bool set_pose(const std::string& robot, const Eigen::Vector2d& p_map);
  /// Only these robots are anywhere in the map: where others were is forgotten.
  void keep_poses(const std::set<std::string>& aligned);

  struct Reply {
    Path path;
    std::optional<Path> ended;  ///< the last word on the path whose place this one takes
  };

  /// Plans on the grid as of the last `project`. A request that comes again (same robot, same id) gets the path it has
  /// now. One that is kept active ends the robot's kept one before. `radius` holds where the request has none.
  Reply request(const PathRequest& request, double radius, const Moment& moment);

  /// Plans anew for active paths that are blocked, or may be possible now; the longest waiting first, so many that one
  /// call stays short: call it again and again. Returns those whose result is another than before.
  std::vector<Path> replan(const Moment& moment);

  /// The active paths of which nothing was said for a second. One that still holds is given as of this moment's
  /// revision; one that waits to be planned anew, as of the revision it was found on.
  std::vector<Path> repeat(const Moment& moment);

  [[nodiscard]] std::size_t active_count() const { return active_.size(); }

 private:
  struct Active {
    PathRequest request;
    double radius = 0;
    Path path;
    std::vector<Eigen::Vector2d> points;
    std::optional<Eigen::Vector2d> start;  ///< where it was planned from
    Region reached;                        ///< by the search, if it failed
    Region but_for_zones;                  ///< where its reason, that zones close the way, holds
    std::int64_t said = 0;                 ///< when it was last published
    std::int64_t turn = 0;                 ///< in which it is to be planned anew; 0: it is not
  };

  std::int64_t try_to_plan(Active& active, const Moment& moment) const;
  [[nodiscard]] PlanResult answer(const Active& active) const;
  void check_active(const ZoneLayer::Change& change);
  [[nodiscard]] bool must_replan(const Active& active, const ZoneLayer::Change& change) const;
  [[nodiscard]] bool has_moved(const Active& active, const Eigen::Vector2d& p_map) const;
  [[nodiscard]] std::vector<Active*> due(const Moment& moment);
  [[nodiscard]] const Path* known(const PathRequest& request) const;
  std::optional<Path> end(const std::string& robot);
  void remember(const Path& path);
  void wait(Active& active);

  BrickMap map_;
  std::vector<BrickIndex> touched_;
  Grid grid_;
  ZoneLayer zones_;
  bool has_zones_ = false;  ///< they have been said, be it that there are none
  std::map<std::string, Eigen::Vector2d> poses_;
  std::map<std::string, Active> active_;  ///< by robot
  std::int64_t turns_ = 0;                ///< given out so far
  std::deque<Path> recent_;               ///< answers that are not kept active, oldest first
};

}  // namespace concord
