#include "planner/pose_plan.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "planner/ends.hpp"
#include "planner/se2/pose_check.hpp"

namespace concord {
namespace {

PosePlan refusal(Reason reason, std::string message) {
  PosePlan plan;
  plan.reason = reason;
  plan.message = std::move(message);
  return plan;
}

End target_at(const Eigen::Vector2d& p, std::size_t leg, std::size_t count) {
  return leg + 1 < count ? waypoint_at(p, leg + 1) : goal_at(p);
}

PosePlan failed_at(std::size_t leg, std::size_t count, PosePlan plan) {
  plan.legs = {static_cast<std::int32_t>(leg)};
  if (leg + 1 == count || plan.reason == Reason::kSearchLimit) return plan;
  plan.reason = Reason::kWaypointUnreachable;
  plan.message = "waypoint " + std::to_string(leg + 1) + " cannot be reached: " + plan.message;
  return plan;
}

PosePlan too_near_for(const End& end) {
  return refusal(end.clearance, "at " + describe(end) +
                                    " the footprint overlaps a wall, an unobserved cell, a robot or a no-go zone: turn "
                                    "it or move it away");
}

}  // namespace

PosePlanner::PosePlanner(const Terrain& terrain, Body body) : terrain_(terrain), body_(std::move(body)) {}

std::int64_t PosePlanner::cells() const {
  return area_ ? std::int64_t{area_->open().width()} * area_->open().height() : 0;
}

ColumnFloor PosePlanner::floor_of(BrickIndex column) const {
  return {column, terrain_.at(column).passable, terrain_.costs(column)};
}

void PosePlanner::lay_out() {
  if (area_) {
    for (const BrickIndex column : touched_) {
      if (!area_->holds(column)) {
        if (terrain_.grid().cells().find(column) == nullptr) continue;  // nobody is ever there
        // The rectangle has grown: all of it anew.
        area_.reset();
        break;
      }
      const ColumnFloor floor = floor_of(column);
      (void)area_->set(floor);
      if (ground_) changed_.push_back(floor);
    }
  }
  touched_.clear();
  if (area_) return;
  ground_.reset();
  changed_.clear();
  BrickIndex low{kMaxVoxel, kMaxVoxel, 0}, high{-kMaxVoxel, -kMaxVoxel, 0};
  const BrickMap& known = terrain_.grid().cells();
  known.for_each_brick([&](BrickIndex b, const Brick&) {
    low = {std::min(low.x, b.x), std::min(low.y, b.y), 0};
    high = {std::max(high.x, b.x), std::max(high.y, b.y), 0};
  });
  const std::int64_t width = 8 * (std::int64_t{high.x} - low.x + 1), height = 8 * (std::int64_t{high.y} - low.y + 1);
  if (width < 1 || height < 1 || width * height > kMaxCells || std::max(width, height) > OpenGrid::kMaxSide) return;
  area_ = std::make_unique<PoseArea>(low, high);
  made_ += width * height;
  known.for_each_brick([&](BrickIndex b, const Brick&) { (void)area_->set(floor_of({b.x, b.y, 0})); });
}

void PosePlanner::prepare() {
  lay_out();
  if (!area_ || (ground_ && ground_->search)) return;
  // A search of no length makes it.
  begin({}, {})->run();
}

void PosePlanner::update(std::span<const BrickIndex> columns) {
  if (area_) touched_.insert(columns.begin(), columns.end());
}

std::optional<PosePlan> PosePlanner::check(const Pose& start, std::span<const PoseTarget> targets) {
  const bool are_numbers =
      start.is_finite() && std::all_of(targets.begin(), targets.end(), [](const PoseTarget& target) {
        return target.p.allFinite() && std::isfinite(target.yaw.value_or(0));
      });
  if (!are_numbers) return refusal(Reason::kBadRequest, "start and goal must be numbers");
  const double turn = body_.turn_radius;
  const bool turns = turn == 0 || (turn >= kMinTurnRadius && turn <= kMaxTurnRadius);
  if (!turns) return refusal(Reason::kBadRequest, "the turn radius must be 0, or from 0.01 to 100 m");
  if (body_.footprint.circumscribed() / terrain_.resolution() > kMaxRadiusCells) {
    return refusal(Reason::kBadRequest, "the footprint reaches further than 1024 cells");
  }
  if (terrain_.grid().cells().empty()) {
    return refusal(Reason::kNoMap, "nothing has been observed in the height band yet");
  }
  if (auto wrong = check_cell(terrain_, start_at(start.p))) return refusal(wrong->reason, std::move(wrong->message));
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (auto wrong = check_cell(terrain_, target_at(targets[i].p, i, targets.size()))) {
      return failed_at(i, targets.size(), refusal(wrong->reason, std::move(wrong->message)));
    }
  }
  lay_out();
  if (!area_) return refusal(Reason::kSearchLimit, "the map is too big to plan for a footprint: over 16 million cells");
  return std::nullopt;
}

std::shared_ptr<PoseQuest> PosePlanner::begin(const Pose& start, std::vector<PoseTarget> targets) {
  lay_out();
  if (!ground_) {
    const double per_cell = 1 / terrain_.resolution();
    ground_ = std::make_shared<PoseGround>(
        PoseGround{*area_, body_.footprint.scaled(per_cell), body_.turn_radius * kChordRadius * per_cell, {}, nullptr});
  }
  ground_->changed.insert(ground_->changed.end(), changed_.begin(), changed_.end());
  changed_.clear();
  return std::make_shared<PoseQuest>(ground_, start, std::move(targets), terrain_.resolution());
}

/// The validator's frame begins at the area's corner.
std::optional<std::string> PosePlanner::fault(std::span<const Pose> poses) const {
  const double r = terrain_.resolution();
  std::vector<Pose> local(poses.begin(), poses.end());
  for (Pose& pose : local) pose.p -= area_->corner() * r;
  return fault_of({area_->open(), r, body_.footprint, body_.turn_radius, local.front(), local.back()}, local);
}

PosePlanner::Room PosePlanner::room(std::span<const Pose> poses) {
  lay_out();
  if (!area_) return {std::vector<double>(poses.size(), 0.0), 0.0};
  const double r = terrain_.resolution();
  std::vector<Pose> local(poses.begin(), poses.end());
  for (Pose& pose : local) pose.p -= area_->corner() * r;
  PoseClearance clearance = clearance_of(
      {area_->open(), r, body_.footprint, body_.turn_radius, local.front(), local.back()}, local, kClearanceReach);
  return {std::move(clearance.at), clearance.least};
}

double PosePlanner::cost(std::span<const Pose> poses) {
  lay_out();
  double sum = 0;
  const double r = terrain_.resolution();
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Eigen::Vector2d way = poses[i].p - poses[i - 1].p;
    const int samples = 1 + static_cast<int>(way.norm() / r);
    for (int k = 0; area_ && k < samples; ++k) {
      const Eigen::Vector2d p = (poses[i - 1].p + way * ((k + 0.5) / samples)) / r - area_->corner();
      const Cell cell{static_cast<std::int32_t>(std::floor(p.x())), static_cast<std::int32_t>(std::floor(p.y()))};
      const int extra = area_->costs().holds(cell) ? area_->costs().at(cell) : 0;
      sum += way.norm() / samples * (1 + extra);
    }
  }
  return sum;
}

bool PosePlanner::is_clear(std::span<const Pose> poses, const Window& cells) {
  lay_out();
  if (!area_) return false;
  const double r = terrain_.resolution();
  const double reach = body_.footprint.circumscribed() + r;
  const Eigen::Vector2d low = Eigen::Vector2d(cells.low.x, cells.low.y) * r - Eigen::Vector2d::Constant(reach);
  const Eigen::Vector2d high =
      Eigen::Vector2d(cells.high.x + 1, cells.high.y + 1) * r + Eigen::Vector2d::Constant(reach);
  const auto comes_near = [&](const Pose& a, const Pose& b) {
    return (a.p.cwiseMin(b.p).array() <= high.array()).all() && (a.p.cwiseMax(b.p).array() >= low.array()).all();
  };
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (comes_near(poses[i - 1], poses[i]) && fault(poses.subspan(i - 1, 2))) return false;
  }
  return poses.size() > 1 || !fault(poses);
}

PosePlan PosePlanner::refusal_of(const PoseQuest& quest) const {
  const std::size_t leg = quest.legs().size() - 1;
  const PoseRoute& route = quest.legs().back();
  const std::size_t count = quest.count();
  switch (route.outcome) {
    case PoseOutcome::kStartBlocked: {
      if (leg == 0) return too_near_for(start_at(quest.places().front().p));
      return failed_at(leg - 1, count, too_near_for(target_at(quest.places()[leg].p, leg - 1, count)));
    }
    case PoseOutcome::kGoalBlocked:
      return failed_at(leg, count, too_near_for(target_at(quest.places().back().p, leg, count)));
    case PoseOutcome::kNoWay:
      return failed_at(leg, count,
                       refusal(Reason::kNoValidPath,
                               "no way through: even the largest disc in the footprint is cut off from the goal, by "
                               "walls, no-go zones or space not yet observed"));
    case PoseOutcome::kGaveUp:
      return failed_at(
          leg, count,
          refusal(Reason::kSearchLimit, "no way was found in " + std::to_string(route.steps) +
                                            " steps: it may be too narrow for the footprint or its turns"));
    case PoseOutcome::kFound:
    case PoseOutcome::kStopped: break;
  }
  PosePlan stopped;
  stopped.stopped = true;
  return stopped;
}

PosePlan PosePlanner::finish(const PoseQuest& quest, std::int64_t map_revision) {
  lay_out();
  PosePlan plan;
  double length = 0;
  for (const PoseRoute& leg : quest.legs()) {
    plan.steps += leg.steps;
    length += leg.length * terrain_.resolution();
  }
  const std::int64_t steps = plan.steps;
  if (quest.legs().back().outcome != PoseOutcome::kFound) {
    plan = refusal_of(quest);
  } else if (!area_) {
    plan = refusal(Reason::kSearchLimit, "the map is too big to plan for a footprint: over 16 million cells");
  } else {
    for (std::size_t leg = 0; leg < quest.legs().size(); ++leg) {
      const std::vector<Pose>& poses = quest.legs()[leg].poses;
      for (std::size_t i = leg == 0 ? 0 : 1; i < poses.size(); ++i) {
        const Pose& pose = poses[i];
        plan.poses.push_back({(pose.p + quest.corner()) * terrain_.resolution(), wrapped(pose.yaw)});
        plan.legs.push_back(static_cast<std::int32_t>(leg));
      }
      // Exactly as they were asked for.
      if (leg == 0) plan.poses.front() = quest.places().front();
      plan.poses.back() = quest.places()[leg + 1];
    }
    if (const auto fault = this->fault(plan.poses)) {
      plan = refusal(Reason::kValidationFailed,
                     "the path that was found does not stand the final check, " + *fault + ": report this");
    } else {
      Room room = this->room(plan.poses);
      plan.reason = Reason::kOk;
      plan.clearance = std::move(room.at);
      plan.least_clearance = room.least;
      plan.length = length;
      plan.message = "a path of " + metres(plan.length) + ", with at least " + metres(plan.least_clearance) +
                     " around the footprint";
      const bool is_sampled = std::any_of(quest.legs().begin(), quest.legs().end(),
                                          [](const PoseRoute& leg) { return leg.means != PoseMeans::kGuided; });
      if (is_sampled && area_->costs().has_any()) {
        plan.message += "; it was hard to find, and what zones cost is hardly heeded";
      }
    }
  }
  plan.steps = steps;
  plan.map_revision = map_revision;
  return plan;
}

PosePlan PosePlanner::plan(const Pose& start, const Pose& goal, std::int64_t map_revision,
                           const std::function<bool()>& stop) {
  std::vector<PoseTarget> targets{{goal.p, goal.yaw}};
  if (auto refused = check(start, targets)) return *refused;
  const auto quest = begin(start, std::move(targets));
  quest->run(stop);
  return finish(*quest, map_revision);
}

}  // namespace concord
