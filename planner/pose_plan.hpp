#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "planner/footprint/footprint.hpp"
#include "planner/plan.hpp"
#include "planner/pose_quest.hpp"

namespace concord {

/// A robot that is not round.
struct Body {
  Footprint footprint;
  double turn_radius = 0;  ///< metres, 0: turns in place

  [[nodiscard]] bool operator==(const Body& other) const {
    return turn_radius == other.turn_radius && footprint.polygon() == other.footprint.polygon();
  }
};

/// A path for such a robot.
struct PosePlan {
  Reason reason = Reason::kNoMap;
  bool stopped = false;  ///< whoever asked withdrew, or watches the clock: there is no result, `reason` means nothing
  std::string message;   ///< for a person
  /// Map frame, metres, from the exact start to the exact goal; empty unless kOk. From one to the next the reference
  /// point goes straight and the yaw changes evenly, the shorter way round; the true arc between them is clear as well.
  std::vector<Pose> poses;
  std::vector<std::int32_t> legs;  ///< of each pose; if one fails, that one alone
  std::vector<double> clearance;   ///< by pose, metres, as far as kClearanceReach
  double length = 0;               ///< of the reference point's way, metres
  double least_clearance = 0;      ///< from the footprint to a cell that is not free, or no-go, metres
  std::int64_t map_revision = 0;   ///< what it was checked against, as it was given
  std::int64_t steps = 0;          ///< of the searches
};

/// Plans for one footprint on one terrain, and keeps what depends on the terrain alone.
/// Allow-contact zones are not heeded: the footprint keeps clear of all that is not free.
class PosePlanner {
 public:
  static constexpr double kMaxTurnRadius = 100.0;
  static constexpr double kMinTurnRadius = 0.01;
  /// Of the rectangle around all known cells; about 30 bytes each.
  static constexpr std::int64_t kMaxCells = 16'000'000;
  static constexpr double kClearanceReach = 1.0;

  /// The terrain's layers must outlive this and change only along with `update`.
  PosePlanner(const Terrain& terrain, Body body);

  /// Works out what depends on the terrain alone; without this, the first question does it.
  void prepare();

  /// These columns of the terrain have changed; they are looked at when it is next asked.
  void update(std::span<const BrickIndex> columns);

  /// Any input is answered; the same in the same way. Map frame, metres. `stop` is asked again and again.
  [[nodiscard]] PosePlan plan(const Pose& start, const Pose& goal, std::int64_t map_revision,
                              const std::function<bool()>& stop);

  /// The same in parts. What no search is needed for to refuse; else `begin` may be called.
  [[nodiscard]] std::optional<PosePlan> check(const Pose& start, std::span<const PoseTarget> targets);
  /// On the terrain as it is now. @pre check found nothing against it; what was begun before has been run.
  [[nodiscard]] std::shared_ptr<PoseQuest> begin(const Pose& start, std::vector<PoseTarget> targets);
  /// What came of it, held against the terrain as it is now. @pre it is done.
  [[nodiscard]] PosePlan finish(const PoseQuest& quest, std::int64_t map_revision);

  /// Whether the poses still stand the validator where they come near these cells of the map. @pre they did before the
  /// cells changed.
  [[nodiscard]] bool is_clear(std::span<const Pose> poses, const Window& cells);
  struct Room {
    std::vector<double> at;  ///< by pose, metres, as far as kClearanceReach
    double least = 0;
  };
  /// Around the footprint, on the terrain as it is now.
  [[nodiscard]] Room room(std::span<const Pose> poses);
  /// The way of the reference point, metres, where zones ask for it so many times more.
  [[nodiscard]] double cost(std::span<const Pose> poses);

  [[nodiscard]] const Body& body() const { return body_; }
  /// That it keeps.
  [[nodiscard]] std::int64_t cells() const;
  /// Cells that were laid out so far: what it took.
  [[nodiscard]] std::int64_t made() const { return made_; }

 private:
  void lay_out();
  [[nodiscard]] ColumnFloor floor_of(BrickIndex column) const;
  [[nodiscard]] std::optional<std::string> fault(std::span<const Pose> poses) const;
  [[nodiscard]] PosePlan refusal_of(const PoseQuest& quest) const;

  Terrain terrain_;
  Body body_;
  std::set<BrickIndex> touched_;
  std::unique_ptr<PoseArea> area_;      ///< what the validator looks at; none while it is not worked out, or too large
  std::shared_ptr<PoseGround> ground_;  ///< what searches look at, in whatever thread: left alone but by `begin`
  std::vector<ColumnFloor> changed_;    ///< of the area, that the ground has not been told of
  std::int64_t made_ = 0;
};

}  // namespace concord
