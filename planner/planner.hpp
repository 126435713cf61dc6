#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/brick_map.hpp"
#include "core/requests.hpp"
#include "planner/grid.hpp"
#include "planner/plan.hpp"

namespace concord {

/// The planner's state: a copy of the map, its grid, where robots are, and the paths that are kept active.
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

  explicit Planner(Grid grid) : grid_(std::move(grid)) {}

  void set_brick(BrickIndex index, Brick brick);
  void clear_map();
  /// Brings the grid up to date; finds the active paths that the change touches. Returns the columns that changed.
  std::vector<BrickIndex> project();
  [[nodiscard]] const Grid& grid() const { return grid_; }

  /// Where a robot is, map frame. False if it is one robot too many.
  bool set_pose(const std::string& robot, const Eigen::Vector2d& p_map);

  /// Plans on the grid as of the last `project`. A request that comes again (same robot, same id) gets the path it has
  /// now. The newest request of a robot ends the one before. `radius` holds where the request has none.
  Path request(const PathRequest& request, double radius, const Moment& moment);

  /// Plans anew for active paths that are blocked, or may be possible now; the longest waiting first, so many that one
  /// call stays short: call it again and again. Returns those whose result is another than before.
  std::vector<Path> replan(const Moment& moment);

  [[nodiscard]] std::size_t active_count() const { return active_.size(); }

 private:
  struct Active {
    PathRequest request;
    double radius = 0;
    Path path;
    std::vector<Eigen::Vector2d> points;
    bool is_waiting = false;  ///< stands in waiting_
  };

  [[nodiscard]] std::optional<Eigen::Vector2d> start_of(const PathRequest& request) const;
  [[nodiscard]] PlanResult plan_for(const PathRequest& request, double radius) const;
  [[nodiscard]] bool must_replan(const Active& active, const std::vector<ColumnChange>& changes) const;
  [[nodiscard]] Path* known(const PathRequest& request);
  void remember(const Path& path);
  void wait(const std::string& robot, Active& active);

  BrickMap map_;
  std::vector<BrickIndex> touched_;
  Grid grid_;
  std::map<std::string, Eigen::Vector2d> poses_;
  std::map<std::string, Active> active_;  ///< by robot
  std::deque<std::string> waiting_;       ///< robots to be replanned; some may have gone
  std::deque<Path> recent_;               ///< oldest first
};

}  // namespace concord
