#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "planner/free_space.hpp"
#include "planner/reason.hpp"

namespace concord {

/// Where a path begins, passes or ends, and the words and reasons that are its own.
struct End {
  std::string what;          ///< "start"
  Eigen::Vector2d position;  ///< map frame, metres
  Reason outside, no_go, occupied, unknown, clearance;
};
[[nodiscard]] End start_at(const Eigen::Vector2d& position);
[[nodiscard]] End goal_at(const Eigen::Vector2d& position);

/// Why nobody can be there.
struct Objection {
  Reason reason = Reason::kOk;
  std::string message;  ///< for a person
};

/// What is wrong with the cell that the end lies in, whoever comes.
[[nodiscard]] std::optional<Objection> check_cell(const Terrain& terrain, const End& end);
/// What a robot there would overlap. @pre it does: its disc is not clear in `space`.
[[nodiscard]] Objection too_near(const Terrain& terrain, const End& end, double radius);
[[nodiscard]] Objection too_narrow(const End& end, double radius);

[[nodiscard]] std::string metres(double value);
[[nodiscard]] std::string describe(const End& end);

/// The cells around `p` (in cells) that the robot can go to in a straight line, the nearest first. Those one step away
/// from p's own are left out where that one serves: a search gets there by itself.
[[nodiscard]] std::vector<Cell> anchors(FreeSpace& space, const Eigen::Vector2d& p);

}  // namespace concord
