#include "planner/pose_quest.hpp"

#include <cmath>
#include <new>

namespace concord {
namespace {

/// Of all legs, beyond the last: others wait meanwhile. As many as two take that find nothing.
constexpr std::int64_t kMostSteps = 170'000;

}  // namespace

PoseArea::PoseArea(BrickIndex low, BrickIndex high)
    : low_(low), high_(high), open_(8 * (high.x - low.x + 1), 8 * (high.y - low.y + 1)), costs_(open_) {}

Window PoseArea::set(const ColumnFloor& floor) {
  const Cell corner{(floor.column.x - low_.x) * 8, (floor.column.y - low_.y) * 8};
  for (int local = 0; local < 64; ++local) {
    const Cell cell{corner.x + (local & 7), corner.y + (local >> 3)};
    open_.set(cell, (floor.passable >> local & 1) != 0);
    costs_.set(cell, floor.costs[static_cast<std::size_t>(local)]);
  }
  return {corner, {corner.x + 7, corner.y + 7}};
}

PoseQuest::PoseQuest(std::shared_ptr<PoseGround> ground, const Pose& start, std::vector<PoseTarget> targets,
                     double resolution)
    : ground_(std::move(ground)), targets_(std::move(targets)), resolution_(resolution), places_{start} {}

/// What changed before the search is made is in the area when it is made.
void PoseQuest::catch_up() {
  for (const ColumnFloor& floor : ground_->changed) {
    const Window window = ground_->area.set(floor);
    if (ground_->search) ground_->search->update(window);
  }
  ground_->changed.clear();
  if (ground_->search) return;
  ground_->search = std::make_unique<PoseSearch>(ground_->area.open(), ground_->footprint, ground_->turn_radius,
                                                 &ground_->area.costs());
}

Pose PoseQuest::in_cells(const Pose& pose) const { return {pose.p / resolution_ - corner(), pose.yaw}; }

/// With the yaw that was asked for, or one along the way from the place before to the one behind.
Pose PoseQuest::place(std::size_t target) const {
  const Eigen::Vector2d& p = targets_[target].p;
  if (targets_[target].yaw) return {p, *targets_[target].yaw};
  const Eigen::Vector2d& next = target + 1 < targets_.size() ? targets_[target + 1].p : p;
  const Eigen::Vector2d way = next - places_.back().p;
  const double along = way.norm() > 0 ? std::atan2(way.y(), way.x()) : places_.back().yaw;
  constexpr int kYaws = 16;
  for (int i = 0; i < kYaws; ++i) {
    // To the left and to the right in turn, ever further.
    const int steps = (i % 2 == 0 ? 1 : -1) * ((i + 1) / 2);
    const Pose pose{p, wrapped(along + steps * 2 * M_PI / kYaws)};
    if (ground_->search->room().stands(in_cells(pose))) return pose;
  }
  return {p, along};
}

void PoseQuest::run(const std::function<bool()>& stop) {
  try {
    search(stop);
  } catch (const std::bad_alloc&) {
    ground_->search.reset();
    legs_.push_back({PoseOutcome::kGaveUp, PoseMeans::kNone, {}, 0, 0});
  }
  done_ = true;
}

void PoseQuest::search(const std::function<bool()>& stop) {
  catch_up();
  PoseEffort effort;
  effort.stop = [&] { return withdrawn_ || (stop && stop()); };
  std::int64_t steps = 0;
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    const Pose to = place(i);
    legs_.push_back(steps < kMostSteps ? ground_->search->find(in_cells(places_.back()), in_cells(to), effort)
                                       : PoseRoute{PoseOutcome::kGaveUp, PoseMeans::kNone, {}, 0, steps});
    steps += legs_.back().steps;
    places_.push_back(to);
    // A short leg may be found without the effort's ever being asked about.
    if (legs_.back().outcome == PoseOutcome::kFound && effort.stop()) legs_.back().outcome = PoseOutcome::kStopped;
    if (legs_.back().outcome != PoseOutcome::kFound) break;
  }
}

}  // namespace concord
