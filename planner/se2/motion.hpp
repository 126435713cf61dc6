#pragma once

#include <array>
#include <span>
#include <vector>

#include "planner/footprint/standing_room.hpp"
#include "planner/search/extra_costs.hpp"

namespace concord {

/// How a robot gets from one pose to another: up to five moves. Poses in cells.
struct Motion {
  Pose from, to;  ///< `to` is where the moves lead, but for rounding
  std::array<Move, 5> moves{};
  int count = 0;

  [[nodiscard]] double length() const;
};

/// The pose before each move of a motion.
template <class Take>
void for_each_move(const Motion& motion, Take take) {
  Pose at = motion.from;
  for (int i = 0; i < motion.count; ++i) {
    const Move& move = motion.moves[static_cast<std::size_t>(i)];
    if (!take(at, move)) return;
    at = move.from(at);
  }
}

/// Whether the robot has room all along, its end too.
[[nodiscard]] bool has_room(const StandingRoom& room, const Motion& motion);

/// What motions cost: the way, more of it near what is blocked and where zones ask for it, going back and changing
/// between ahead and back, turns in place. In cells.
class MotionCost {
 public:
  static constexpr double kBack = 1.5;
  static constexpr double kNear = 1.0;    ///< so much more at the wall
  static constexpr double kChange = 0.5;  ///< of the footprint's radius
  static constexpr double kTurn = 0.5;    ///< of the footprint's radius for each radian in place

  /// `room` must outlive this, and so must `extra`: what it costs besides to have the reference point in a cell. Null:
  /// nothing does.
  explicit MotionCost(const StandingRoom& room, const ExtraCosts* extra = nullptr);

  [[nodiscard]] double operator()(const Motion& motion) const;

 private:
  [[nodiscard]] double factor(const Eigen::Vector2d& p) const;

  const StandingRoom& room_;
  const ExtraCosts* extra_;
  double radius_, far_;
};

}  // namespace concord
