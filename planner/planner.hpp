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
#include "planner/plan.hpp"

namespace concord {

/// The planner's state: a copy of the map, its grid, the zones, where robots are, and the paths that are kept active.
/// It is told what happens and when; what it answers is to be published.
class Planner {
 public:
  static constexpr std::size_t kMaxActive = 256;   ///< robots whose path is kept active
  static constexpr std::size_t kMaxPoses = 1024;   ///< robots whose pose is kept
  static constexpr std::size_t kKeptPaths = 256;   ///< requests that are answered alike when they come again
  static constexpr std::size_t kMaxWaiting = 256;  ///< requests that are not answered yet

  /// What a path is planned at.
  struct Moment {
    std::int64_t map_revision = 0;
    std::int64_t utime = 0;
  };

  explicit Planner(Grid grid);
  Planner(const Planner&) = delete;
  Planner& operator=(const Planner&) = delete;

  void set_brick(BrickIndex index, Brick brick);
  void clear_map();
  /// Brings the grid up to date, and what is kept of paths. Returns the columns that changed.
  std::vector<BrickIndex> project();
  [[nodiscard]] const Grid& grid() const { return grid_; }

  /// All zones that hold from now on. Before the first call there is no path: nobody knows where robots may not go.
  void set_zones(std::span<const Zone> zones);
  [[nodiscard]] const ZoneLayer& zones() const { return zones_; }
  [[nodiscard]] Terrain terrain() const { return {grid_, zones_}; }

  /// Where a robot is, map frame. False if it is one robot too many.
  bool set_pose(const std::string& robot, const Eigen::Vector2d& p_map);
  /// Only these robots are anywhere in the map: where others were is forgotten.
  void keep_poses(const std::set<std::string>& aligned);

  struct Reply {
    std::optional<Path> path;   ///< none: it waits for its turn, and `serve` will have it
    std::optional<Path> ended;  ///< the last word on the path whose place this one takes
  };

  /// Plans on the grid as of the last `project`, if what is done in one call of `serve` is not done yet. A request that
  /// comes again (same robot, same id) gets the path it has now. One that is kept active ends the robot's kept one
  /// before. `radius` holds where the request has none.
  Reply request(const PathRequest& request, double radius, const Moment& moment);

  /// Answers to requests that waited, the longest waiting first, and `replan` goes on from there: so many that both
  /// together stay short. Call both again and again.
  std::vector<Reply> serve(const Moment& moment);
  /// Plans anew for active paths that are blocked, or may be possible now, or much shorter; the longest waiting first.
  /// Returns those whose result is another than before.
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
    std::optional<Route> route;            ///< as far as it is looked for or found
    std::vector<Changed> changes;          ///< that the route has not followed yet
    std::int64_t said = 0;                 ///< when it was last published
    std::int64_t turn = 0;                 ///< in which it is to be looked at; 0: it is not
    std::int64_t begun = 0;                ///< version of the terrain that the search from scratch began on
    bool must_begin_anew = false;          ///< the robot has left its path
  };

  /// Between two calls of `serve` about so many cells may be looked at: some 100 ms.
  static constexpr std::int64_t kEffort = 1'000'000;
  static constexpr Changed kAnything{{{-kMaxVoxel, -kMaxVoxel}, {kMaxVoxel, kMaxVoxel}}, true};

  [[nodiscard]] RobotTask task(const Active& active) { return {grids_, active.radius}; }
  [[nodiscard]] std::optional<Objection> objection(const Active& active) const;
  [[nodiscard]] bool find(Active& active, const Moment& moment);
  [[nodiscard]] bool keep_up(Active& active, const Moment& moment);
  void take(Active& active, PlanResult result, const Moment& moment) const;
  [[nodiscard]] Reply settle(Active active, const Moment& moment);
  void changed(const ZoneLayer::Change& change);
  void follow(Active& active, const std::vector<Changed>& changes);
  [[nodiscard]] bool comes_near(const Active& active, const std::vector<Changed>& changes) const;
  [[nodiscard]] bool is_far_off(const Active& active, const Eigen::Vector2d& p_map) const;
  [[nodiscard]] bool has_moved(const Active& active, const Eigen::Vector2d& p_map) const;
  [[nodiscard]] std::vector<Active*> due(const Moment& moment);
  [[nodiscard]] std::optional<Reply> known(const PathRequest& request) const;
  std::optional<Path> end(const std::string& robot);
  void remember(const Path& path);
  void wait(Active& active);

  BrickMap map_;
  std::vector<BrickIndex> touched_;
  Grid grid_;
  ZoneLayer zones_;
  RobotGrids grids_;
  bool has_zones_ = false;  ///< they have been said, be it that there are none
  std::map<std::string, Eigen::Vector2d> poses_;
  std::map<std::string, Active> active_;  ///< by robot
  std::deque<Active> waiting_;            ///< not answered yet
  std::int64_t version_ = 0;              ///< of the terrain
  std::int64_t turns_ = 0;                ///< given out so far
  std::int64_t effort_ = 0;               ///< since the last call of `serve`, in cells looked at
  std::deque<Path> recent_;               ///< answers that are not kept active, oldest first
};

}  // namespace concord
