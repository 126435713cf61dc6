#include "planner/pose_plan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
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

}  // namespace

/// One end of the path and the reasons that are its own.
struct PosePlanner::End {
  const char* what;
  Pose pose;
  Reason outside, no_go, occupied, unknown, clearance;

  [[nodiscard]] std::string name() const {
    char text[128];
    std::snprintf(text, sizeof(text), "the %s (%.2f, %.2f, %.2f)", what, pose.p.x(), pose.p.y(), pose.yaw);
    return text;
  }
  [[nodiscard]] PosePlan too_near() const {
    return refusal(clearance, "at " + name() +
                                  " the footprint overlaps a wall, an unobserved cell or a no-go zone: turn it or move "
                                  "it away");
  }
};

PosePlanner::PosePlanner(const Grid& grid, const ZoneLayer& zones, Footprint footprint, double turn_radius)
    : grid_(grid), zones_(zones), footprint_(std::move(footprint)), turn_radius_(turn_radius) {}

bool PosePlanner::holds(BrickIndex column) const {
  return column.x >= low_.x && column.y >= low_.y && column.x <= high_.x && column.y <= high_.y;
}

void PosePlanner::copy(BrickIndex column) {
  const std::uint64_t passable = Terrain(grid_, zones_).at(column).passable;
  for (int local = 0; local < 64; ++local) {
    const Cell cell{(column.x - low_.x) * 8 + (local & 7), (column.y - low_.y) * 8 + (local >> 3)};
    open_->set(cell, (passable >> local & 1) != 0);
  }
}

void PosePlanner::prepare() {
  if (search_) return;
  open_.reset();
  low_ = {kMaxVoxel, kMaxVoxel, 0};
  high_ = {-kMaxVoxel, -kMaxVoxel, 0};
  grid_.cells().for_each_brick([&](BrickIndex b, const Brick&) {
    low_ = {std::min(low_.x, b.x), std::min(low_.y, b.y), 0};
    high_ = {std::max(high_.x, b.x), std::max(high_.y, b.y), 0};
  });
  const std::int64_t width = 8 * (std::int64_t{high_.x} - low_.x + 1),
                     height = 8 * (std::int64_t{high_.y} - low_.y + 1);
  if (width < 1 || height < 1 || width * height > kMaxCells) return;
  open_ = std::make_unique<OpenGrid>(static_cast<int>(width), static_cast<int>(height));
  grid_.cells().for_each_brick([&](BrickIndex b, const Brick&) { copy(b); });
  const double per_cell = 1 / grid_.resolution();
  search_ = std::make_unique<PoseSearch>(*open_, footprint_.scaled(per_cell), turn_radius_ * kChordRadius * per_cell);
}

void PosePlanner::update(std::span<const BrickIndex> columns) {
  if (!search_) return;
  for (const BrickIndex& column : columns) {
    if (!holds(column)) return search_.reset();  // the rectangle has grown: all of it anew when it is next needed
  }
  for (const BrickIndex& column : columns) {
    copy(column);
    const Cell corner{(column.x - low_.x) * 8, (column.y - low_.y) * 8};
    search_->update({corner, {corner.x + 7, corner.y + 7}});
  }
}

std::optional<PosePlan> PosePlanner::check_cell(const End& end) const {
  const Eigen::Vector2d p = end.pose.p / grid_.resolution();
  const std::string where = end.name();
  if (p.cwiseAbs().maxCoeff() >= kMaxVoxel) return refusal(end.outside, where + " lies outside the map");
  const Cell cell = cell_of(p);
  if (const std::string* zone = zones_.no_go_at(cell)) {
    return refusal(end.no_go, where + " lies in the no-go zone '" + *zone + "'");
  }
  const LogOdds state = grid_.at(cell);
  if (is_free(state)) return std::nullopt;
  if (is_known(state)) return refusal(end.occupied, where + " is occupied");
  if (holds({cell.x >> 3, cell.y >> 3, 0})) return refusal(end.unknown, where + " has not been observed free");
  return refusal(end.outside, where + " lies outside the map");
}

Pose PosePlanner::to_cells(const Pose& pose) const {
  return {pose.p / grid_.resolution() - 8.0 * Eigen::Vector2d(low_.x, low_.y), pose.yaw};
}

PosePlan PosePlanner::finish(const PoseRoute& route, const Pose& start, const Pose& goal) const {
  const double r = grid_.resolution();
  const Eigen::Vector2d corner = 8 * r * Eigen::Vector2d(low_.x, low_.y);
  PosePlan plan;
  for (const Pose& pose : route.poses) plan.poses.push_back({pose.p * r + corner, wrapped(pose.yaw)});
  plan.poses.front() = start;
  plan.poses.back() = goal;
  // The validator's frame begins at the rectangle's corner.
  std::vector<Pose> local = plan.poses;
  for (Pose& pose : local) pose.p -= corner;
  const PoseTerms terms{*open_, r, footprint_, turn_radius_, local.front(), local.back()};
  if (const auto fault = fault_of(terms, local)) {
    return refusal(Reason::kValidationFailed,
                   "the path that was found does not stand the final check, " + *fault + ": report this");
  }
  const PoseClearance clearance = clearance_of(terms, local, kClearanceReach);
  plan.reason = Reason::kOk;
  plan.clearance = clearance.at;
  plan.least_clearance = clearance.least;
  plan.length = route.length * r;
  plan.message =
      "a path of " + metres(plan.length) + ", with at least " + metres(plan.least_clearance) + " around the footprint";
  return plan;
}

PosePlan PosePlanner::plan(const Pose& start, const Pose& goal, std::int64_t map_revision,
                           const std::function<bool()>& stop) {
  const double r = grid_.resolution();
  if (!start.is_finite() || !goal.is_finite()) return refusal(Reason::kBadRequest, "start and goal must be numbers");
  const bool turns = turn_radius_ == 0 || (turn_radius_ >= kMinTurnRadius && turn_radius_ <= kMaxTurnRadius);
  if (!turns) return refusal(Reason::kBadRequest, "the turn radius must be 0, or from 0.01 to 100 m");
  if (footprint_.circumscribed() / r > kMaxRadiusCells) {
    return refusal(Reason::kBadRequest, "the footprint reaches further than 1024 cells");
  }
  if (grid_.cells().empty()) return refusal(Reason::kNoMap, "nothing has been observed in the height band yet");
  const End from{"start",
                 start,
                 Reason::kStartOutsideMap,
                 Reason::kStartInNoGo,
                 Reason::kStartOccupied,
                 Reason::kStartUnknown,
                 Reason::kStartClearance};
  const End to{"goal",
               goal,
               Reason::kGoalOutsideMap,
               Reason::kGoalInNoGo,
               Reason::kGoalOccupied,
               Reason::kGoalUnknown,
               Reason::kGoalClearance};
  prepare();
  for (const End* end : {&from, &to}) {
    if (auto refused = check_cell(*end)) return *refused;
  }
  if (!search_)
    return refusal(Reason::kSearchLimit, "the map is too big to plan for a footprint: over 16 million cells");
  PoseEffort effort;
  effort.stop = stop;
  const PoseRoute route = search_->find(to_cells(start), to_cells(goal), effort);
  PosePlan plan;
  switch (route.outcome) {
    case PoseOutcome::kFound: plan = finish(route, start, goal); break;
    case PoseOutcome::kStartBlocked: plan = from.too_near(); break;
    case PoseOutcome::kGoalBlocked: plan = to.too_near(); break;
    case PoseOutcome::kNoWay:
      plan = refusal(Reason::kNoValidPath,
                     "no way through: even the largest disc in the footprint is cut off from the "
                     "goal, by walls, no-go zones or space not yet observed");
      break;
    case PoseOutcome::kGaveUp:
      plan = refusal(Reason::kSearchLimit, "no way was found in " + std::to_string(route.steps) +
                                               " steps: it may be too narrow for the footprint or its turns");
      break;
    case PoseOutcome::kStopped: plan.stopped = true; break;
  }
  plan.steps = route.steps;
  plan.map_revision = map_revision;
  return plan;
}

}  // namespace concord
