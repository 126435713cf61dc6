#include "planner/se2/sampled_search.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/SE2StateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

namespace concord {
namespace {

namespace ob = ompl::base;

using State = ob::SE2StateSpace::StateType;

Pose pose_of(const ob::State* state) {
  const auto* s = state->as<State>();
  return {{s->getX(), s->getY()}, s->getYaw()};
}

void set(ob::State* state, const Pose& pose) {
  auto* s = state->as<State>();
  s->setXY(pose.p.x(), pose.p.y());
  s->setYaw(wrapped(pose.yaw));
}

/// The pose after so much of a motion, a turn in place counting by its arc at `radius`.
Pose pose_at(const Motion& motion, double share, double radius) {
  const auto size = [&](const Move& move) { return std::max(std::abs(move.travel), radius * std::abs(move.turn)); };
  double whole = 0;
  for (int i = 0; i < motion.count; ++i) whole += size(motion.moves[static_cast<std::size_t>(i)]);
  double left = share * whole;
  Pose result = motion.to;
  for_each_move(motion, [&](const Pose& at, const Move& move) {
    const double all = size(move);
    result = move.from(at, std::min(1.0, left / all));
    left -= all;
    return left > 0;
  });
  return result;
}

/// Poses at distances that are the robot's to drive.
class DrivenSpace : public ob::SE2StateSpace {
 public:
  DrivenSpace(const Steering& steering, double radius, const OpenGrid& grid) : steering_(steering), radius_(radius) {
    setName("driven");
    ob::RealVectorBounds bounds(2);
    bounds.setLow(0);
    bounds.setHigh(0, grid.width());
    bounds.setHigh(1, grid.height());
    setBounds(bounds);
  }

  double distance(const ob::State* a, const ob::State* b) const override {
    constexpr double kFar = 1e9;
    const auto motion = steering_.connect(pose_of(a), pose_of(b));
    if (!motion) return kFar;
    double sum = 0;
    for (int i = 0; i < motion->count; ++i) {
      const Move& move = motion->moves[static_cast<std::size_t>(i)];
      sum += move.travel == 0 ? radius_ * std::abs(move.turn) : std::abs(move.travel);
    }
    return sum;
  }

  void interpolate(const ob::State* from, const ob::State* to, double t, ob::State* state) const override {
    const auto motion = steering_.connect(pose_of(from), pose_of(to));
    set(state, motion ? pose_at(*motion, t, radius_) : pose_of(from));
  }

  /// Going there may be another way than coming back.
  bool isMetricSpace() const override { return false; }

 private:
  const Steering& steering_;
  double radius_;
};

class RoomValidator : public ob::MotionValidator {
 public:
  RoomValidator(const ob::SpaceInformationPtr& si, const StandingRoom& room, const Steering& steering)
      : ob::MotionValidator(si), room_(room), steering_(steering) {}

  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    const auto motion = steering_.connect(pose_of(a), pose_of(b));
    return motion && has_room(room_, *motion);
  }
  /// How far it would get is not worked out: none of the planners here asks.
  bool checkMotion(const ob::State* a, const ob::State* b, std::pair<ob::State*, double>& last) const override {
    if (checkMotion(a, b)) return true;
    if (last.first != nullptr) si_->copyState(last.first, a);
    last.second = 0;
    return false;
  }

 private:
  const StandingRoom& room_;
  const Steering& steering_;
};

class RegionSampler : public ob::StateSampler {
 public:
  RegionSampler(const ob::StateSpace* space, const SampleRegion& region, std::uint64_t seed)
      : ob::StateSampler(space), region_(region), random_(seed) {}

  void sampleUniform(ob::State* state) override {
    const Cell cell = region_.cells[random_() % region_.cells.size()];
    set(state, around({{cell.x + 0.5, cell.y + 0.5}, 0}, region_.spread, M_PI));
  }
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    set(state, around(pose_of(near), distance, M_PI));
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    set(state, around(pose_of(mean), 2 * deviation, M_PI));
  }

 private:
  /// -1 to 1; the same with every standard library.
  double even() { return static_cast<double>(random_() >> 11) * 0x1p-52 - 1; }

  Pose around(const Pose& pose, double spread, double turn) {
    Pose sample{pose.p + spread * Eigen::Vector2d(even(), 0), pose.yaw};
    sample.p.y() += spread * even();
    sample.yaw += turn * even();
    const auto& bounds = static_cast<const ob::SE2StateSpace*>(space_)->getBounds();
    for (unsigned axis = 0; axis < 2; ++axis) {
      sample.p[axis] = std::clamp(sample.p[axis], bounds.low[axis], bounds.high[axis]);
    }
    return sample;
  }

  const SampleRegion& region_;
  std::mt19937_64 random_;
};

/// The motions between states, each checked again. Empty if one does not stand it.
std::vector<Motion> motions_between(const std::vector<ob::State*>& states, const Pose& start, const Pose& goal,
                                    const StandingRoom& room, const Steering& steering) {
  std::vector<Motion> motions;
  for (std::size_t i = 1; i < states.size(); ++i) {
    const Pose from = i == 1 ? start : pose_of(states[i - 1]);
    const Pose to = i + 1 == states.size() ? goal : pose_of(states[i]);
    const auto motion = steering.connect(from, to);
    if (!motion || !has_room(room, *motion)) return {};
    motions.push_back(*motion);
  }
  return motions;
}

}  // namespace

FoundMotions search_by_samples(const SampleRegion& region, const Pose& start, const Pose& goal,
                               const StandingRoom& room, const Steering& steering, const SearchEffort& effort,
                               std::uint64_t seed) {
  FoundMotions found;
  if (region.cells.empty()) return found;
  ompl::msg::noOutputHandler();
  const double radius = room.footprint().circumscribed();
  const auto space = std::make_shared<DrivenSpace>(steering, radius, room.grid());
  space->setStateSamplerAllocator(
      [&](const ob::StateSpace* of) { return std::make_shared<RegionSampler>(of, region, seed); });
  const auto si = std::make_shared<ob::SpaceInformation>(space);
  si->setStateValidityChecker([&](const ob::State* state) { return room.stands(pose_of(state)); });
  si->setMotionValidator(std::make_shared<RoomValidator>(si, room, steering));
  si->setup();
  const auto problem = std::make_shared<ob::ProblemDefinition>(si);
  ob::ScopedState<ob::SE2StateSpace> from(si), to(si);
  set(from.get(), start);
  set(to.get(), goal);
  problem->setStartAndGoalStates(from, to);
  ompl::geometric::RRTConnect planner(si);
  planner.setRange(4 * std::max(radius, steering.turn_radius()));
  planner.setProblemDefinition(problem);
  planner.setup();
  const ob::PlannerTerminationCondition ends([&] {
    found.stopped = found.stopped || effort.stop();
    return found.stopped || ++found.steps > effort.most;
  });
  if (planner.solve(ends) == ob::PlannerStatus::EXACT_SOLUTION && !found.stopped) {
    const auto path = std::static_pointer_cast<ompl::geometric::PathGeometric>(problem->getSolutionPath());
    found.motions = motions_between(path->getStates(), start, goal, room, steering);
  }
  return found;
}

}  // namespace concord
