#pragma once

#include <span>

#include "planner/leg.hpp"

namespace concord {

/// The legs from a start by way of all waypoints, in their order, to a goal.
class Route {
 public:
  /// Positions in metres.
  Route(const Eigen::Vector2d& start, std::span<const Eigen::Vector2d> waypoints, const Eigen::Vector2d& goal);

  struct Found {
    Finding way;  ///< of all legs; or of the one that fails
    std::vector<std::int32_t>
        legs;              ///< of each point, the leg that ends there or beyond; of a failure, the one that fails
    bool is_fast = false;  ///< any leg is
  };

  /// From scratch, as far as looking at about `effort` cells gets; call it again for the rest. That there is no way is
  /// said at once. Nothing: not done yet. What changes meanwhile is not heeded: check the result.
  [[nodiscard]] std::optional<Found> find(const RobotTask& task, std::int64_t effort);

  /// See Leg::follow; of the legs before the one that the robot is on nothing is left.
  [[nodiscard]] std::optional<Found> follow(const RobotTask& task, const std::vector<Changed>& changes,
                                            const std::optional<Eigen::Vector2d>& at);
  [[nodiscard]] std::optional<Found> improve(const RobotTask& task);

  /// The robot is there: the legs that it has come to the end of are behind it.
  void pass(const Eigen::Vector2d& p, double tolerance);
  /// Where the robot still has to pass.
  [[nodiscard]] std::vector<Eigen::Vector2d> waypoints_left() const;
  /// Cells that the last call looked at.
  [[nodiscard]] std::int64_t expanded() const { return expanded_; }

 private:
  [[nodiscard]] Found joined(bool is_kept) const;
  [[nodiscard]] Found failed(std::size_t leg, Finding finding) const;
  [[nodiscard]] RobotTask share_of(const RobotTask& task) const;

  std::vector<Leg> legs_;
  std::vector<std::vector<Eigen::Vector2d>> ways_;  ///< of the legs found so far, metres
  std::size_t first_ = 0;                           ///< the leg that the robot is on
  std::int64_t expanded_ = 0;
};

}  // namespace concord
