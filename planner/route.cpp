#include "planner/route.hpp"

#include <algorithm>

namespace concord {
namespace {

/// What a leg costs beside its search, in cells looked at.
constexpr std::int64_t kEffortOfALeg = 1'000;

}  // namespace

Route::Route(const Eigen::Vector2d& start, std::span<const Eigen::Vector2d> waypoints, const Eigen::Vector2d& goal) {
  End from = start_at(start);
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    const End to = waypoint_at(waypoints[i], i + 1);
    legs_.emplace_back(from, to);
    from = to;
  }
  legs_.emplace_back(from, goal_at(goal));
}

/// All legs together look at no more than about one search does; each may look at some.
RobotTask Route::share_of(const RobotTask& task) const {
  constexpr std::int64_t kLeast = 20'000;
  RobotTask one = task;
  one.most_expanded = std::max(kLeast, task.most_expanded / static_cast<std::int64_t>(legs_.size()));
  return one;
}

Route::Found Route::failed(std::size_t leg, Finding finding) const {
  if (leg + 1 < legs_.size() && finding.reason != Reason::kSearchLimit) {
    const bool is_start = leg == first_ && finding.message.starts_with("the start");
    if (!is_start) {
      finding.message = legs_[leg].to().what + " cannot be reached: " + finding.message;
      finding.reason = Reason::kWaypointUnreachable;
    }
  }
  return {std::move(finding), {static_cast<std::int32_t>(leg)}, false};
}

std::optional<Route::Found> Route::find(const RobotTask& task, std::int64_t effort) {
  expanded_ = 0;
  const RobotTask one = share_of(task);
  // Those that are left, in each call: the terrain may have changed since the last.
  for (std::size_t leg = ways_.size(); leg < legs_.size(); ++leg) {
    expanded_ += kEffortOfALeg / 10;
    if (auto finding = legs_[leg].check(one)) return failed(leg, std::move(*finding));
  }
  while (ways_.size() < legs_.size()) {
    if (!ways_.empty() && expanded_ >= effort) return std::nullopt;
    Finding finding = legs_[ways_.size()].find(one);
    expanded_ += finding.expanded + kEffortOfALeg;
    ways_.push_back(std::move(finding.points));
  }
  return joined(false);
}

/// Points that come twice, where one leg ends and the next begins, come once.
Route::Found Route::joined(bool is_kept) const {
  Found found;
  found.way.expanded = expanded_;
  found.way.is_kept = is_kept;
  for (std::size_t leg = first_; leg < ways_.size(); ++leg) {
    found.is_fast = found.is_fast || legs_[leg].is_fast();
    for (std::size_t i = leg == first_ ? 0 : 1; i < ways_[leg].size(); ++i) {
      found.way.points.push_back(ways_[leg][i]);
      found.legs.push_back(static_cast<std::int32_t>(leg));
    }
  }
  return found;
}

std::optional<Route::Found> Route::follow(const RobotTask& task, const std::vector<Changed>& changes,
                                          const std::optional<Eigen::Vector2d>& at) {
  if (ways_.size() != legs_.size()) return std::nullopt;
  const RobotTask one = share_of(task);
  expanded_ = 0;
  bool is_kept = true;
  for (std::size_t leg = first_; leg < legs_.size(); ++leg) {
    auto finding = legs_[leg].follow(one, changes, leg == first_ ? at : std::nullopt);
    if (!finding) return std::nullopt;
    expanded_ += finding->expanded + kEffortOfALeg;
    is_kept = is_kept && finding->is_kept;
    ways_[leg] = std::move(finding->points);
  }
  return joined(is_kept);
}

std::optional<Route::Found> Route::improve(const RobotTask& task) {
  if (ways_.size() != legs_.size()) return std::nullopt;
  const RobotTask one = share_of(task);
  expanded_ = 0;
  bool is_better = false;
  for (std::size_t leg = first_; leg < legs_.size(); ++leg) {
    auto points = legs_[leg].improve(one, expanded_);
    if (points.empty()) continue;
    is_better = true;
    ways_[leg] = std::move(points);
  }
  return is_better ? std::optional(joined(false)) : std::nullopt;
}

void Route::pass(const Eigen::Vector2d& p, double tolerance) {
  while (first_ + 1 < legs_.size() && (legs_[first_].to().position - p).norm() <= tolerance) ++first_;
}

std::vector<Eigen::Vector2d> Route::waypoints_left() const {
  std::vector<Eigen::Vector2d> left;
  for (std::size_t leg = first_; leg + 1 < legs_.size(); ++leg) left.push_back(legs_[leg].to().position);
  return left;
}

}  // namespace concord
