#include "planner/se2/motion.hpp"

#include <algorithm>
#include <cmath>

namespace concord {
namespace {

constexpr double kMargin = 10;  ///< cells around the footprint that are better open, too
constexpr double kSample = 4;   ///< cells between looks at how near what is blocked is
constexpr double kFine = 1;     ///< where cells differ in what they cost

}  // namespace

double Motion::length() const {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += std::abs(moves[static_cast<std::size_t>(i)].travel);
  return sum;
}

bool has_room(const StandingRoom& room, const Motion& motion) {
  if (!room.stands(motion.from) || !room.stands(motion.to)) return false;
  bool is_free = true;
  for_each_move(motion, [&](const Pose& at, const Move& move) { return is_free = room.moves(at, move); });
  return is_free;
}

MotionCost::MotionCost(const StandingRoom& room, const ExtraCosts* extra)
    : room_(room), extra_(extra), radius_(room.footprint().circumscribed()), far_(radius_ + kMargin) {}

double MotionCost::factor(const Eigen::Vector2d& p) const {
  const double near = std::max(0.0, 1 - room_.distance(p) / far_);
  const double factor = 1 + kNear * near * near;
  if (extra_ == nullptr) return factor;
  const Cell cell{static_cast<std::int32_t>(std::floor(p.x())), static_cast<std::int32_t>(std::floor(p.y()))};
  return extra_->holds(cell) ? factor + extra_->at(cell) : factor;
}

double MotionCost::operator()(const Motion& motion) const {
  const double sample = extra_ != nullptr && extra_->has_any() ? kFine : kSample;
  double sum = 0;
  int last = 0;
  for_each_move(motion, [&](const Pose& at, const Move& move) {
    const double travel = std::abs(move.travel);
    if (travel == 0) {
      sum += kTurn * radius_ * std::abs(move.turn);
      return true;
    }
    const int count = 1 + static_cast<int>(travel / sample);
    double factors = 0;
    for (int i = 0; i < count; ++i) factors += factor(move.from(at, (i + 0.5) / count).p);
    const int direction = move.travel > 0 ? 1 : -1;
    sum += travel * factors / count * (direction < 0 ? kBack : 1);
    if (last != 0 && direction != last) sum += kChange * radius_;
    last = direction;
    return true;
  });
  return sum;
}

}  // namespace concord
