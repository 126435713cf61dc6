#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "planner/ends.hpp"
#include "planner/robot_grid.hpp"
#include "planner/search/kept_path.hpp"

namespace concord {

/// Cells that a search from scratch looks at before it takes the fast path: some 100 ms.
inline constexpr std::int64_t kMaxExpanded = 1'500'000;

/// For whom, and on what.
struct RobotTask {
  RobotGrids& grids;
  double radius;                              ///< metres
  std::int64_t most_expanded = kMaxExpanded;  ///< by one search

  [[nodiscard]] const Terrain& terrain() const { return grids.terrain(); }
  [[nodiscard]] double in_cells() const { return radius / terrain().resolution(); }
};

/// Where cells have changed, and whether any was opened.
struct Changed {
  Window cells;  ///< of the map
  bool opened;
};

/// What came of looking for a way.
struct Finding {
  Reason reason = Reason::kOk;
  std::string message;                  ///< for a person; empty if there is a way
  std::vector<Eigen::Vector2d> points;  ///< metres, the ends exact; empty unless there is a way
  std::int64_t expanded = 0;            ///< cells that searches looked at
  std::optional<Eigen::Vector2d> cut;   ///< metres: where what cut the way off lies on it
  bool is_kept = false;                 ///< nothing but what the robot has passed is another than before
};

/// The way from one exact point to another, kept up while the terrain changes (`KeptPath`).
class Leg {
 public:
  /// @pre nobody objects to the cells of either (`check_cell`).
  Leg(End from, End to) : from_(std::move(from)), to_(std::move(to)) {}

  /// Whether there is a way, without a search. Nothing: there is.
  [[nodiscard]] std::optional<Finding> check(const RobotTask& task);
  /// From scratch. @pre check found nothing against it, on the terrain as it is.
  [[nodiscard]] Finding find(const RobotTask& task);

  /// After these changes; what still serves of the way is kept. The robot may have gone along it to `at` (metres).
  /// Nothing: no way is kept that begins near there; find anew.
  [[nodiscard]] std::optional<Finding> follow(const RobotTask& task, const std::vector<Changed>& changes,
                                              const std::optional<Eigen::Vector2d>& at);
  /// Looks for a way that costs less by more than a share, if one may have opened. Empty: there is none. Adds to
  /// `expanded` what it looked at.
  [[nodiscard]] std::vector<Eigen::Vector2d> improve(const RobotTask& task, std::int64_t& expanded);

  [[nodiscard]] const End& to() const { return to_; }
  /// Whether the way is a fast path, which heeds neither walls nor costs.
  [[nodiscard]] bool is_fast() const { return kept_ && kept_->path() && kept_->path()->is_fast; }

 private:
  struct Ends {
    Eigen::Vector2d from, to;  ///< cells
  };

  [[nodiscard]] Ends in_cells(const RobotTask& task) const;
  [[nodiscard]] std::shared_ptr<RobotGrid> bind(const RobotTask& task);
  [[nodiscard]] bool begin_at(RobotGrid& grid, const Eigen::Vector2d& p);
  [[nodiscard]] Finding found(const RobotTask& task, RobotGrid& grid) const;

  End from_, to_;
  std::optional<std::pair<Cell, Cell>> anchors_;  ///< of the map; none if the way is one straight line
  std::optional<KeptPath> kept_;                  ///< none without anchors
  std::weak_ptr<RobotGrid> grid_;
  Cell origin_;  ///< of that grid
};

}  // namespace concord
