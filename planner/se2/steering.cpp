#include "planner/se2/steering.hpp"

#include <cmath>

#include <ompl/base/spaces/ReedsSheppStateSpace.h>

namespace concord {
namespace {

constexpr double kNothing = 1e-9;

void add(Motion& motion, const Move& move) {
  if (std::abs(move.travel) < kNothing && std::abs(move.turn) < kNothing) return;
  motion.moves[static_cast<std::size_t>(motion.count++)] = move;
}

/// Ahead or back, whichever turns less; ahead if it is the same.
Motion turn_and_go(const Pose& from, const Pose& to) {
  Motion motion{from, to, {}, 0};
  const Eigen::Vector2d way = to.p - from.p;
  const double travel = way.norm();
  if (travel < kNothing) {
    add(motion, {0, wrapped(to.yaw - from.yaw)});
    return motion;
  }
  const double ahead = std::atan2(way.y(), way.x());
  const auto turns = [&](double heading) { return std::pair(wrapped(heading - from.yaw), wrapped(to.yaw - heading)); };
  const auto [a0, a1] = turns(ahead);
  const auto [b0, b1] = turns(ahead + M_PI);
  const bool is_back = std::abs(b0) + std::abs(b1) < std::abs(a0) + std::abs(a1) - kNothing;
  add(motion, {0, is_back ? b0 : a0});
  add(motion, {is_back ? -travel : travel, 0});
  add(motion, {0, is_back ? b1 : a1});
  return motion;
}

bool arrives(const Motion& motion) {
  Pose end = motion.from;
  for_each_move(motion, [&](const Pose& at, const Move& move) {
    end = move.from(at);
    return true;
  });
  constexpr double kSpoilt = 1e-5;  // cells; radians
  return (end.p - motion.to.p).norm() < kSpoilt && std::abs(wrapped(end.yaw - motion.to.yaw)) < kSpoilt;
}

}  // namespace

struct Steering::ReedsShepp {
  using Space = ompl::base::ReedsSheppStateSpace;

  Space space{1.0};
  Space::StateType* from = space.allocState()->as<Space::StateType>();
  Space::StateType* to = space.allocState()->as<Space::StateType>();

  ReedsShepp() = default;
  ReedsShepp(const ReedsShepp&) = delete;
  ReedsShepp& operator=(const ReedsShepp&) = delete;
  ~ReedsShepp() {
    space.freeState(from);
    space.freeState(to);
  }
};

Steering::Steering(double turn_radius) : turn_radius_(turn_radius) {
  if (turn_radius > 0) reeds_shepp_ = std::make_unique<ReedsShepp>();
}
Steering::~Steering() = default;
Steering::Steering(Steering&&) noexcept = default;
Steering& Steering::operator=(Steering&&) noexcept = default;

std::optional<Motion> Steering::connect(const Pose& from, const Pose& to) const {
  if (!reeds_shepp_) return turn_and_go(from, to);
  // In turn radii, from the first pose: numbers stay small.
  const Eigen::Vector2d way = (to.p - from.p) / turn_radius_;
  reeds_shepp_->from->setXY(0, 0);
  reeds_shepp_->from->setYaw(wrapped(from.yaw));
  reeds_shepp_->to->setXY(way.x(), way.y());
  reeds_shepp_->to->setYaw(wrapped(to.yaw));
  using Space = ReedsShepp::Space;
  const auto path = reeds_shepp_->space.reedsShepp(reeds_shepp_->from, reeds_shepp_->to);
  Motion motion{from, to, {}, 0};
  for (std::size_t i = 0; i < 5; ++i) {
    const double along = path.length_[i];
    switch (path.type_[i]) {
      case Space::RS_NOP: break;
      case Space::RS_LEFT: add(motion, {along * turn_radius_, along}); break;
      case Space::RS_RIGHT: add(motion, {along * turn_radius_, -along}); break;
      case Space::RS_STRAIGHT: add(motion, {along * turn_radius_, 0}); break;
    }
  }
  if (!arrives(motion)) return std::nullopt;
  return motion;
}

}  // namespace concord
