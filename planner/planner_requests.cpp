// How the planner answers requests, in turns.
#include <algorithm>
#include <array>
#include <utility>

#include "planner/planner.hpp"

namespace concord {
namespace {

/// Between two tries of a search that failed, and between two times that a path is said.
constexpr std::int64_t kSecond = 1'000'000;

/// A clock that was set back makes nothing recent.
bool is_recent(std::int64_t utime, std::int64_t now) { return utime <= now && now - utime < kSecond; }

bool is_failed_search(const Path& path) {
  constexpr std::array kFailures{Reason::kNoValidPath,      Reason::kWaypointUnreachable, Reason::kBlockedByEdit,
                                 Reason::kBlockedByUnknown, Reason::kSearchLimit,         Reason::kBusy};
  return std::any_of(kFailures.begin(), kFailures.end(), [&](Reason reason) { return path.status == name(reason); });
}

}  // namespace

/// What the request has now, if it was answered before or waits.
std::optional<Planner::Reply> Planner::known(const PathRequest& request) const {
  const auto is_it = [&](const Path& path) { return path.id == request.id && path.robot == request.robot; };
  const auto active = active_.find(request.robot);
  if (active != active_.end() && is_it(active->second.path)) return Reply{active->second.path, {}};
  const auto it = std::find_if(recent_.begin(), recent_.end(), is_it);
  if (it != recent_.end()) return Reply{*it, {}};
  const bool waits = std::any_of(waiting_.begin(), waiting_.end(), [&](const Active& other) {
    return other.request.id == request.id && other.request.robot == request.robot;
  });
  return waits ? std::optional(Reply{}) : std::nullopt;
}

void Planner::remember(const Path& path) {
  recent_.push_back(path);
  if (recent_.size() > kKeptPaths) recent_.pop_front();
}

std::optional<Path> Planner::end(const std::string& robot) {
  const auto it = active_.find(robot);
  if (it == active_.end()) return std::nullopt;
  Path last = std::move(it->second.path);
  active_.erase(it);
  last.active = false;
  last.message = "ended: another request of the robot's has taken its place";
  remember(last);
  return last;
}

std::vector<Planner::Cancelled> Planner::cancel(const std::string& robot, const Moment& moment) {
  std::vector<Cancelled> ended;
  const auto finish_off = [&](Active& active, bool was_answered) {
    const Path before = active.path;
    PlanResult result;
    result.reason = Reason::kCancelled;
    result.message = "cancelled as it was asked for";
    take(active, std::move(result), moment);
    active.path.plan_number = before.plan_number;
    active.path.superseded = before.path_id;
    remember(active.path);
    ended.push_back({active.path, was_answered});
  };
  if (const auto it = active_.find(robot); it != active_.end()) {
    finish_off(it->second, true);
    active_.erase(it);
  }
  for (Active& active : waiting_) {
    if (active.request.robot == robot) finish_off(active, false);
  }
  std::erase_if(waiting_, [&](const Active& active) { return active.request.robot == robot; });
  return ended;
}

std::optional<Planner::Cut> Planner::cut_of(const std::string& robot, std::int64_t path_id) {
  const auto it = active_.find(robot);
  if (it == active_.end() || it->second.path.path_id != path_id || !it->second.cut) return std::nullopt;
  return Cut{*std::exchange(it->second.cut, std::nullopt), it->second.level->grid().band()};
}

std::optional<Path> Planner::name_edit(const std::string& robot, std::int64_t path_id, const std::string& edit,
                                       const std::string& author) {
  const auto it = active_.find(robot);
  if (it == active_.end() || it->second.path.path_id != path_id) return std::nullopt;
  it->second.path.edit_id = edit;
  it->second.path.message += "; there lies edit " + edit + (author.empty() ? "" : " by " + author);
  return it->second.path;
}

Planner::Reply Planner::request(const PathRequest& request, const Robot& robot, const Moment& moment) {
  if (auto reply = known(request)) return *reply;
  Active now;
  now.request = request;
  now.robot = robot;
  if (request.radius > 0) now.robot.radius = request.radius;
  if (!request.footprint.empty()) {
    const auto footprint = Footprint::make(request.footprint);
    if (footprint) now.robot.body = Body{*footprint, request.turn_radius};
    if (!footprint) now.refused = Objection{Reason::kBadRequest, "the footprint: " + footprint.error().message};
  }
  if (now.robot.body && request.radius > 0) {
    now.refused = Objection{Reason::kBadRequest, request.robot + " has a footprint: ask without a radius"};
  }
  if (now.robot.body) now.robot.radius = now.robot.body->footprint.circumscribed();
  now.level = level_for(robot);
  const bool has_room = waiting_.size() < kMaxWaiting;
  const bool may_begin = has_room || !now.robot.body;  // with a body it would have to wait
  if (may_begin && effort_ < kEffort && !is_anybodys_turn() && find(now, moment)) {
    return settle(std::move(now), moment);
  }
  if (has_room) {
    waiting_.push_back(std::move(now));
    return {};
  }
  PlanResult busy;
  busy.reason = Reason::kBusy;
  busy.message = "so many requests wait already: ask again later";
  take(now, std::move(busy), moment);
  return {now.path, {}};
}

/// What becomes of a request that has been answered.
Planner::Reply Planner::settle(Active active, const Moment& moment) {
  const PathRequest& request = active.request;
  const bool has_room = active_.size() < kMaxActive || active_.contains(request.robot);
  if (request.keep_active && !has_room) {
    active.path.message += "; it is not kept active, as so many robots' paths are already";
  }
  if (!request.keep_active || !has_room || active.path.status == name(Reason::kBadRequest)) {
    remember(active.path);
    return {active.path, {}};
  }
  active.path.active = true;
  active.said = moment.utime;
  const auto before = active_.find(request.robot);
  if (before != active_.end()) active.path.superseded = before->second.path.path_id;
  Reply reply{active.path, end(request.robot)};
  const std::string robot = request.robot;
  const auto kept = active_.emplace(robot, std::move(active)).first;
  if (kept->second.is_outdated) wait(kept->second);
  return reply;
}

std::vector<Planner::Reply> Planner::serve(const Moment& moment) {
  effort_ = 0;
  std::vector<Reply> replies;
  for (auto it = waiting_.begin(); it != waiting_.end() && effort_ < kEffort;) {
    if (find(*it, moment)) {
      Active done = std::move(*it);
      it = waiting_.erase(it);
      replies.push_back(settle(std::move(done), moment));
    } else if (it->job) {
      ++it;  // its search runs beside this: others need not wait for it
    } else {
      break;
    }
  }
  return replies;
}

/// Whether somebody waits for the next call of `serve`.
bool Planner::is_anybodys_turn() const {
  return std::any_of(waiting_.begin(), waiting_.end(), [](const Active& active) { return !active.job; });
}

void Planner::wait(Active& active) {
  if (active.turn == 0) active.turn = ++turns_;
}

std::vector<Planner::Active*> Planner::due(const Moment& moment) {
  std::vector<Active*> due;
  for (auto& [robot, active] : active_) {
    const bool rests = active.points.empty() && !active.route && !active.job && is_failed_search(active.path) &&
                       is_recent(active.path.utime, moment.utime);
    if (active.turn != 0 && !rests) due.push_back(&active);
  }
  std::sort(due.begin(), due.end(), [](const Active* a, const Active* b) { return a->turn < b->turn; });
  return due;
}

std::vector<Path> Planner::replan(const Moment& moment) {
  std::vector<Path> changed;
  for (Active* active : due(moment)) {
    if (effort_ >= kEffort) break;
    const Path before = active->path;
    const std::string found_before = active->found;
    const bool left_a_zone = active->exit.has_value();
    const bool is_kept = active->robot.body ? keep_up_poses(*active) : keep_up(*active, moment);
    if (!is_kept) {
      const bool was_found = !active->points.empty();
      if (was_found) active->route.reset();
      active->points.clear();
      active->poses.clear();
      active->must_begin_anew = false;
      if (!find(*active, moment)) {
        if (!was_found || !active->job) continue;
        // That it does not hold any more is said now: the next may take seconds.
        PlanResult none;
        none.reason = Reason::kReplanning;
        none.message = "the path does not hold any more, and another is looked for: stop";
        take(*active, std::move(none), moment);
      }
    }
    active->turn = 0;
    if (active->job || active->is_outdated) wait(*active);
    const bool is_another = active->path.status != before.status || active->path.points != before.points ||
                            left_a_zone != active->exit.has_value() ||
                            (active->points.empty() && active->found != found_before);
    if (!is_another && active->points.empty()) {
      active->path.message = before.message;
      active->path.edit_id = before.edit_id;
      active->cut.reset();
    }
    active->path.active = true;
    active->path.plan_number = before.plan_number + (is_another ? 1 : 0);
    if (active->path.path_id != before.path_id) active->path.superseded = before.path_id;
    if (!is_another) {
      active->path.path_id = before.path_id;
      active->path.superseded = before.superseded;
      continue;
    }
    active->said = moment.utime;
    changed.push_back(active->path);
  }
  return changed;
}

std::vector<Path> Planner::kept() const {
  std::vector<Path> paths;
  for (const auto& [robot, active] : active_) paths.push_back(active.path);
  return paths;
}

std::vector<Path> Planner::repeat(const Moment& moment) {
  std::vector<Path> paths;
  for (auto& [robot, active] : active_) {
    if (is_recent(active.said, moment.utime)) continue;
    if (active.turn == 0) active.path.map_revision = moment.map_revision;
    active.said = moment.utime;
    paths.push_back(active.path);
    if (is_stale_) paths.back().message += "; nothing was heard of the map for some seconds: it is as of then";
  }
  return paths;
}

}  // namespace concord
