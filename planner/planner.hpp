#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/brick_map.hpp"
#include "core/requests.hpp"
#include "planner/level.hpp"
#include "planner/plan.hpp"

namespace concord {

/// What the site says of a robot that a path is for.
struct Robot {
  double radius = 0.3;                                 ///< metres
  double speed = 0.5;                                  ///< m/s
  std::optional<Body> body = {};                       ///< none: a disc of `radius`; else that is the disc around it
  std::optional<std::pair<double, double>> band = {};  ///< heights, map z, metres; none: the planner's
};

/// The planner's state: a copy of the map, its grids, the zones, where robots are, and the paths that are kept active.
/// It is told what happens and when; what it answers is to be published.
class Planner {
 public:
  static constexpr std::size_t kMaxActive = 256;   ///< robots whose path is kept active
  static constexpr std::size_t kMaxPoses = 1024;   ///< robots whose pose is kept
  static constexpr std::size_t kKeptPaths = 256;   ///< requests that are answered alike when they come again
  static constexpr std::size_t kMaxWaiting = 256;  ///< requests that are not answered yet
  static constexpr std::size_t kMaxLevels = 8;     ///< height bands at once

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
  [[nodiscard]] const Grid& grid() const { return levels_.front()->grid(); }

  /// All zones that hold from now on. Before the first call there is no path: nobody knows where robots may not go.
  void set_zones(std::span<const Zone> zones);
  [[nodiscard]] const ZoneLayer& zones() const { return levels_.front()->zones(); }
  [[nodiscard]] Terrain terrain() const { return levels_.front()->terrain(); }

  /// Where a robot is, and where it points, map frame. With a radius it stands in the way of the others, at all
  /// heights. False if it is one robot too many.
  bool set_pose(const std::string& robot, const Eigen::Vector2d& p_map, double radius = 0.0, double yaw = 0.0);
  /// Only these robots are anywhere in the map: where others were is forgotten.
  void keep_poses(const std::set<std::string>& aligned);

  struct Reply {
    std::optional<Path> path;   ///< none: it waits for its turn, and `serve` will have it
    std::optional<Path> ended;  ///< the last word on the path whose place this one takes
  };

  /// Plans on the grid as of the last `project`, if what is done in one call of `serve` is not done yet. A request that
  /// comes again (same robot, same id) gets the path it has now. One that is kept active ends the robot's kept one
  /// before. The robot's radius holds where the request has none.
  Reply request(const PathRequest& request, const Robot& robot, const Moment& moment);
  struct Cancelled {
    Path path;
    bool was_answered;  ///< else the request waited for its turn
  };
  /// Ends what is kept or waits for the robot. Returns the last word on each.
  std::vector<Cancelled> cancel(const std::string& robot, const Moment& moment);
  /// Whether nobody has heard of the map for so long that nothing new is planned on it.
  void set_stale(bool stale) { is_stale_ = stale; }

  /// Answers to requests that waited, the longest waiting first, and `replan` goes on from there: so many that both
  /// together stay short. Call both again and again.
  std::vector<Reply> serve(const Moment& moment);
  /// Plans anew for active paths that are blocked, or may be possible now, or much shorter; the longest waiting first.
  /// Returns those whose result is another than before.
  std::vector<Path> replan(const Moment& moment);

  /// The active paths of which nothing was said for a second. One that still holds is given as of this moment's
  /// revision; one that waits to be planned anew, as of the revision it was found on.
  std::vector<Path> repeat(const Moment& moment);

  /// The next search for a robot that is not round, if none is under way: to be run in any thread, until it is done.
  /// What comes of it, `serve` and `replan` have. Who destroys the planner sees to it first that none runs.
  [[nodiscard]] std::shared_ptr<PoseQuest> next_quest();

  [[nodiscard]] std::size_t active_count() const { return active_.size(); }
  struct Cut {
    Eigen::Vector2d p;  ///< map frame, metres
    Band band;
  };
  /// Where an edit cuts off the way that this kept path is about; given once, for whoever finds the edit.
  [[nodiscard]] std::optional<Cut> cut_of(const std::string& robot, std::int64_t path_id);
  /// That edit has been found. The path to be said anew, unless it has become another meanwhile.
  [[nodiscard]] std::optional<Path> name_edit(const std::string& robot, std::int64_t path_id, const std::string& edit,
                                              const std::string& author);
  /// The robots' paths that are kept now, as they were last said or would be.
  [[nodiscard]] std::vector<Path> kept() const;

 private:
  /// A search for poses that waits for its turn or is under way; withdrawn when it is forgotten.
  struct PoseJob {
    std::string robot;
    Level* level;
    Body body;
    Pose start;
    std::vector<PoseTarget> targets;
    bool begins_at_robot = false;           ///< wherever that is when its turn comes
    bool stops_a_robot = false;             ///< it has been told to wait for it
    std::optional<PosePlan> refused = {};   ///< when its turn came
    std::shared_ptr<PoseQuest> quest = {};  ///< none before that

    PoseJob(std::string of, Level* on, Body with, const Pose& from, std::vector<PoseTarget> to)
        : robot(std::move(of)), level(on), body(std::move(with)), start(from), targets(std::move(to)) {}
    [[nodiscard]] bool is_over() const { return refused || (quest && quest->is_done()); }
    PoseJob(const PoseJob&) = delete;
    PoseJob& operator=(const PoseJob&) = delete;
    ~PoseJob() {
      if (quest) quest->withdraw();
    }
  };
  struct Active {
    PathRequest request;
    Robot robot;
    Level* level = nullptr;
    Path path;
    std::string found;  ///< its message as it was found; more may have been learned since
    std::vector<Eigen::Vector2d> points;
    std::optional<Eigen::Vector2d> start;  ///< where it was planned from
    std::optional<Route> route;            ///< as far as it is looked for or found
    std::optional<WayOut> exit;            ///< before it
    std::vector<Changed> changes;          ///< that the route has not followed yet
    std::int64_t said = 0;                 ///< when it was last published
    std::int64_t turn = 0;                 ///< in which it is to be looked at; 0: it is not
    std::int64_t begun = 0;                ///< version of the terrain that the search from scratch began on
    std::optional<Eigen::Vector2d> cut;    ///< where an edit cuts the way off, until it is asked about
    bool must_begin_anew = false;          ///< the robot has left its path
    std::optional<Objection> refused;      ///< what it was asked for cannot be
    std::vector<Pose> poses;               ///< `points` with yaws, of a robot with a body
    double cost = 0;                       ///< of these, when they were found
    std::shared_ptr<PoseJob> job;          ///< while one is looked for
    int tries = 0;                         ///< of searches that a change came into
    bool is_outdated = false;              ///< no way was found on a map that has changed since
  };

  /// Between two calls of `serve` about so many cells may be looked at: some 100 ms.
  static constexpr std::int64_t kEffort = 1'000'000;
  /// To hold one against the map.
  static constexpr std::int64_t kEffortOfAPose = 100;

  [[nodiscard]] static RobotTask task(const Active& active) { return {active.level->grids(), active.robot.radius}; }
  [[nodiscard]] Level* level_for(const Robot& robot);
  void heed(const Level* level, const Level::Update& update);
  [[nodiscard]] std::optional<Objection> objection(const Active& active) const;
  [[nodiscard]] bool find(Active& active, const Moment& moment);
  [[nodiscard]] bool keep_up(Active& active, const Moment& moment);
  [[nodiscard]] static std::vector<PoseTarget> targets_of(const PathRequest& request);
  [[nodiscard]] std::optional<PlanResult> begin_poses(Active& active);
  [[nodiscard]] std::shared_ptr<PoseJob> next_job();
  [[nodiscard]] bool find_poses(Active& active, const Moment& moment);
  [[nodiscard]] bool keep_up_poses(Active& active);
  static void tell_of(Active& active, const std::vector<double>& clearance);
  void charge(std::int64_t looked_at);
  [[nodiscard]] bool is_anybodys_turn() const;
  void take(Active& active, PlanResult result, const Moment& moment);
  static void measure(Active& active);
  [[nodiscard]] std::optional<Eigen::Vector2d> nearest(const Active& active, const PlanResult& result) const;
  [[nodiscard]] Reply settle(Active active, const Moment& moment);
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
  std::vector<std::unique_ptr<Level>> levels_;  ///< the first is the site's
  std::vector<Zone> said_zones_;
  bool has_zones_ = false;  ///< they have been said, be it that there are none
  struct Standing {
    Eigen::Vector2d p;  ///< metres
    double radius;      ///< as an obstacle; 0: it is none
    double yaw;
  };
  std::map<std::string, Standing> poses_;
  std::map<std::string, Active> active_;  ///< by robot
  std::deque<Active> waiting_;            ///< not answered yet
  std::deque<std::weak_ptr<PoseJob>> jobs_;
  bool was_for_stopped_ = false;  ///< the last search
  std::shared_ptr<PoseQuest> running_;
  std::int64_t version_ = 0;  ///< of the terrain
  bool is_stale_ = false;
  std::int64_t turns_ = 0;      ///< given out so far
  std::int64_t last_path_ = 0;  ///< path_id
  std::int64_t effort_ = 0;     ///< since the last call of `serve`, in cells looked at
  std::int64_t made_ = 0;       ///< cells of rectangles, as far as they are in it
  std::deque<Path> recent_;     ///< answers that are not kept active, oldest first
};

}  // namespace concord
