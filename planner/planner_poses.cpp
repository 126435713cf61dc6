// How the planner finds paths for robots that are not round, and what becomes of them: searches may take seconds, so
// they run beside it, one at a time.
#include <algorithm>
#include <cmath>
#include <utility>

#include "planner/blame.hpp"
#include "planner/planner.hpp"

namespace concord {
namespace {

constexpr std::int64_t kEffortOfAPlan = 2'000;
/// A path that does not stand the validator because something changed while it was looked for is looked for again.
constexpr int kMostTries = 5;
/// More than that, and one request could keep a search busy for the better part of an hour.
constexpr std::size_t kMostPlaces = 100;

PlanResult result_of(PosePlan plan) {
  PlanResult result;
  result.reason = plan.reason;
  result.message = std::move(plan.message);
  for (const Pose& pose : plan.poses) result.points.push_back(pose.p);
  result.legs = std::move(plan.legs);
  result.length = plan.length;
  result.least_clearance = plan.least_clearance;
  return result;
}

/// What cut the way off, for the largest disc in the footprint.
void blame(const RobotTask& inner, const PoseQuest& quest, PlanResult& result) {
  if (quest.legs().back().outcome != PoseOutcome::kNoWay) return;
  const std::vector<Pose>& places = quest.places();
  const double r = inner.terrain().resolution();
  Finding finding = what_closes(inner, places[places.size() - 2].p / r, places.back().p / r);
  result.cut = finding.cut;
  if (result.reason == Reason::kNoValidPath) {
    result.reason = finding.reason;
    result.message = std::move(finding.message);
  } else {
    result.message = "waypoint " + std::to_string(quest.legs().size()) + " cannot be reached: " + finding.message;
  }
}

}  // namespace

std::vector<PoseTarget> Planner::targets_of(const PathRequest& request) {
  std::vector<PoseTarget> targets;
  for (const Eigen::Vector2d& waypoint : request.waypoints) targets.push_back({waypoint, {}});
  targets.push_back({request.goal, request.goal_yaw});
  return targets;
}

/// Refused at once, or in the queue.
std::optional<PlanResult> Planner::begin_poses(Active& active) {
  const auto refuse = [](Reason reason, std::string message) {
    PlanResult result;
    result.reason = reason;
    result.message = std::move(message);
    return result;
  };
  const auto pose = poses_.find(active.request.robot);
  Pose start;
  if (active.request.start) {
    start = {*active.request.start, active.request.start_yaw};
  } else if (pose != poses_.end()) {
    start = {pose->second.p, pose->second.yaw};
  }
  active.start = active.request.start || pose != poses_.end() ? std::optional(start.p) : std::nullopt;
  if (const auto wrong = objection(active)) return refuse(wrong->reason, wrong->message);
  const auto targets = targets_of(active.request);
  if (targets.size() > kMostPlaces) {
    return refuse(Reason::kBadRequest, "a robot with a footprint has at most 99 waypoints");
  }
  const auto planner = active.level->poses().at(active.request.robot, *active.robot.body);
  if (auto refused = planner->check(start, targets)) return result_of(std::move(*refused));
  active.begun = version_;
  active.job = std::make_shared<PoseJob>(active.request.robot, active.level, *active.robot.body, start, targets);
  active.job->begins_at_robot = !active.request.start;
  active.job->stops_a_robot = active.path.active;
  std::erase_if(jobs_, [](const std::weak_ptr<PoseJob>& job) { return job.expired(); });
  jobs_.push_back(active.job);
  return std::nullopt;
}

/// Robots that stand still until it is done go first, but one other between two of them: neither waits for ever.
std::shared_ptr<Planner::PoseJob> Planner::next_job() {
  std::erase_if(jobs_, [](const std::weak_ptr<PoseJob>& job) { return job.expired(); });
  if (jobs_.empty()) return nullptr;
  const bool wanted = !was_for_stopped_;
  auto it = std::find_if(jobs_.begin(), jobs_.end(),
                         [&](const std::weak_ptr<PoseJob>& job) { return job.lock()->stops_a_robot == wanted; });
  if (it == jobs_.end()) it = jobs_.begin();
  const std::shared_ptr<PoseJob> job = it->lock();
  jobs_.erase(it);
  was_for_stopped_ = job->stops_a_robot;
  return job;
}

std::shared_ptr<PoseQuest> Planner::next_quest() {
  if (running_ && !running_->is_done()) return nullptr;
  running_.reset();
  while (const std::shared_ptr<PoseJob> job = next_job()) {
    if (const auto pose = poses_.find(job->robot); job->begins_at_robot && pose != poses_.end()) {
      job->start = {pose->second.p, pose->second.yaw};  // it has waited
    }
    job->level->look_as(job->robot);
    const auto planner = job->level->poses().at(job->robot, job->body);
    job->refused = planner->check(job->start, job->targets);
    charge(kEffortOfAPlan);
    if (!job->refused) return running_ = job->quest = planner->begin(job->start, job->targets);
  }
  return nullptr;
}

/// False: it is in the queue, or under way.
bool Planner::find_poses(Active& active, const Moment& moment) {
  active.is_outdated = false;
  if (!active.job) {
    auto refused = begin_poses(active);
    charge(kEffortOfAPlan);
    if (!refused) return false;
    take(active, std::move(*refused), moment);
    return true;
  }
  active.start = active.job->start.p;
  const std::shared_ptr<PoseJob> job = std::exchange(active.job, nullptr);
  // Not of necessity the planner that began it: that may have been dropped meanwhile, and know nothing of changes
  // since.
  const auto planner = active.level->poses().at(active.request.robot, *active.robot.body);
  PosePlan found = job->refused ? std::move(*job->refused) : planner->finish(*job->quest, moment.map_revision);
  charge(kEffortOfAPlan + static_cast<std::int64_t>(found.poses.size()) * kEffortOfAPose);
  if (found.reason != Reason::kOk && active.begun != version_) {
    if (++active.tries < kMostTries) return find_poses(active, moment);
    active.is_outdated = true;
    if (found.reason == Reason::kValidationFailed) {
      found.reason = Reason::kBusy;
      found.message = "the map changed under the search again and again: ask again";
    }
  }
  active.tries = 0;
  active.changes.clear();
  PlanResult result = result_of(found);
  if (const auto wrong = objection(active)) {
    result = PlanResult{};
    result.reason = wrong->reason;
    result.message = wrong->message;
  } else if (job->quest) {
    blame({active.level->grids(), active.robot.body->footprint.inscribed()}, *job->quest, result);
  }
  if (result.reason == Reason::kOk) result.zones = zones_near(task(active), result.points);
  take(active, std::move(result), moment);
  active.poses = active.points.empty() ? std::vector<Pose>() : std::move(found.poses);
  active.cost = planner->cost(active.poses);
  tell_of(active, found.clearance);
  return true;
}

/// What is told of each pose.
void Planner::tell_of(Active& active, const std::vector<double>& clearance) {
  double time = 0;
  const double outer = active.robot.body->footprint.circumscribed();
  for (std::size_t i = 0; i < active.poses.size(); ++i) {
    const Pose& pose = active.poses[i];
    if (i > 0) {
      const Pose& before = active.poses[i - 1];
      // In a turn nothing of the robot goes faster than it may.
      const double turned = std::abs(wrapped(pose.yaw - before.yaw)) * outer;
      time += std::max((pose.p - before.p).norm(), turned) / active.robot.speed;
    }
    PathPoint& point = active.path.details[i];
    point = {pose.yaw, clearance[i], point.leg, time};
  }
}

/// Whether the path still stands where the changes come near it, and zones have not made it dearer by more than a
/// share. It is never improved: nothing is endangered by what opened.
bool Planner::keep_up_poses(Active& active) {
  if (active.poses.empty() || active.must_begin_anew) return false;
  const std::vector<Changed> changes = std::exchange(active.changes, {});
  if (!comes_near(active, changes)) return true;
  active.level->look_as(active.request.robot);
  const auto planner = active.level->poses().at(active.request.robot, *active.robot.body);
  charge(kEffortOfAPlan + static_cast<std::int64_t>(active.poses.size()) * kEffortOfAPose);
  for (const Changed& change : changes) {
    if (!planner->is_clear(active.poses, change.cells)) return false;
  }
  if (planner->cost(active.poses) > active.cost * (1 + KeptPath::kShare)) return false;
  const PosePlanner::Room room = planner->room(active.poses);
  active.path.least_clearance = room.least;
  tell_of(active, room.at);
  return true;
}

}  // namespace concord
