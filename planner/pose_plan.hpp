#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "planner/footprint/footprint.hpp"
#include "planner/plan.hpp"
#include "planner/se2/pose_search.hpp"

namespace concord {

/// A path for a robot that is not round.
struct PosePlan {
  Reason reason = Reason::kNoMap;
  bool stopped = false;  ///< whoever asked withdrew, or watches the clock: there is no result, `reason` means nothing
  std::string message;   ///< for a person
  /// Map frame, metres, from the exact start to the exact goal; empty unless kOk. From one to the next the reference
  /// point goes straight and the yaw changes evenly, the shorter way round; the true arc between them is clear as well.
  std::vector<Pose> poses;
  std::vector<double> clearance;  ///< by pose, metres, as far as kClearanceReach
  double length = 0;              ///< of the reference point's way, metres
  double least_clearance = 0;     ///< from the footprint to a cell that is not free, or no-go, metres
  std::int64_t map_revision = 0;  ///< what it was checked against, as it was given
  std::int64_t steps = 0;         ///< of the searches
};

/// Plans for one footprint on one grid, and keeps what depends on the grid alone.
/// Allow-contact zones are not heeded: the footprint keeps clear of all that is not free.
class PosePlanner {
 public:
  static constexpr double kMaxTurnRadius = 100.0;
  static constexpr double kMinTurnRadius = 0.01;
  /// Of the rectangle around all known cells; about 30 bytes each.
  static constexpr std::int64_t kMaxCells = 16'000'000;
  static constexpr double kClearanceReach = 1.0;

  /// Both must outlive this and change only along with `update`. `turn_radius` in metres, 0: turns in place.
  PosePlanner(const Grid& grid, const ZoneLayer& zones, Footprint footprint, double turn_radius);

  /// Works out what depends on the grid alone; without this, the first question does it.
  void prepare();

  /// These columns of the grid or of the zones have changed.
  void update(std::span<const BrickIndex> columns);

  /// Any input is answered; the same in the same way. Map frame, metres. `stop` is asked again and again.
  [[nodiscard]] PosePlan plan(const Pose& start, const Pose& goal, std::int64_t map_revision,
                              const std::function<bool()>& stop);

 private:
  struct End;

  [[nodiscard]] bool holds(BrickIndex column) const;
  void copy(BrickIndex column);
  [[nodiscard]] std::optional<PosePlan> check_cell(const End& end) const;
  [[nodiscard]] Pose to_cells(const Pose& pose) const;
  [[nodiscard]] PosePlan finish(const PoseRoute& route, const Pose& start, const Pose& goal) const;

  const Grid& grid_;
  const ZoneLayer& zones_;
  Footprint footprint_;
  double turn_radius_;
  BrickIndex low_{0, 0, 0}, high_{-1, -1, 0};  ///< columns, both included
  std::unique_ptr<OpenGrid> open_;             ///< none while it is not worked out
  std::unique_ptr<PoseSearch> search_;
};

}  // namespace concord
