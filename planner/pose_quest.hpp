#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "planner/free_space.hpp"
#include "planner/se2/pose_search.hpp"

namespace concord {

/// What the cells of a column of bricks are to a robot with a footprint; bit x + 8 y.
struct ColumnFloor {
  BrickIndex column;
  std::uint64_t passable;
  ColumnCosts costs;
};

/// A rectangle of columns of bricks as cells that a robot may be over, in a grid of its own.
class PoseArea {
 public:
  /// Columns, both included.
  PoseArea(BrickIndex low, BrickIndex high);

  [[nodiscard]] bool holds(BrickIndex column) const {
    return column.x >= low_.x && column.y >= low_.y && column.x <= high_.x && column.y <= high_.y;
  }
  /// @pre it holds the column. Returns the cells of the grid that it lies in.
  Window set(const ColumnFloor& floor);

  [[nodiscard]] const OpenGrid& open() const { return open_; }
  [[nodiscard]] const ExtraCosts& costs() const { return costs_; }
  /// Of the grid, in cells of the map.
  [[nodiscard]] Eigen::Vector2d corner() const { return {8.0 * low_.x, 8.0 * low_.y}; }

 private:
  BrickIndex low_, high_;
  OpenGrid open_;
  ExtraCosts costs_;
};

/// Where a robot is to come by, and how it is to point there; any yaw: one of several, the nearest to the way there
/// that has room. Metres.
struct PoseTarget {
  Eigen::Vector2d p;
  std::optional<double> yaw = {};
};

/// What a search works on, apart from the planner's own: so it may run in another thread while the terrain changes.
struct PoseGround {
  PoseArea area;
  Footprint footprint;                 ///< cells
  double turn_radius;                  ///< cells
  std::vector<ColumnFloor> changed;    ///< that the area has not followed yet
  std::unique_ptr<PoseSearch> search;  ///< none before the first run
};

/// One search for poses by way of several places: begun by the planner, run in any thread, ended by the planner. Of one
/// ground only one is run at a time.
class PoseQuest {
 public:
  /// `targets` as PosePlanner takes them; at least one.
  PoseQuest(std::shared_ptr<PoseGround> ground, const Pose& start, std::vector<PoseTarget> targets, double resolution);

  /// Once. It ends soon after `stop` says so, or who asked withdraws.
  void run(const std::function<bool()>& stop = {});
  /// From any thread: nobody waits for it any longer.
  void withdraw() { withdrawn_ = true; }
  [[nodiscard]] bool is_done() const { return done_; }

  /// From place to place, in cells of the area; the last one may not have been found. @pre is_done.
  [[nodiscard]] const std::vector<PoseRoute>& legs() const { return legs_; }
  /// As it was asked for, with yaws where there were none. @pre is_done.
  [[nodiscard]] const std::vector<Pose>& places() const { return places_; }
  /// In cells of the map.
  [[nodiscard]] Eigen::Vector2d corner() const { return ground_->area.corner(); }
  [[nodiscard]] std::size_t count() const { return targets_.size(); }

 private:
  void search(const std::function<bool()>& stop);
  void catch_up();
  [[nodiscard]] Pose in_cells(const Pose& pose) const;
  [[nodiscard]] Pose place(std::size_t target) const;

  std::shared_ptr<PoseGround> ground_;
  std::vector<PoseTarget> targets_;
  double resolution_;
  std::vector<Pose> places_;  ///< the start first
  std::vector<PoseRoute> legs_;
  std::atomic<bool> withdrawn_ = false, done_ = false;
};

}  // namespace concord
