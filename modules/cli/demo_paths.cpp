// The part of DemoRun in which a robot is sent somewhere, and a person's edit turns it aside.

#include <algorithm>
#include <limits>
#include <tuple>

#include "cli/demo_run.hpp"
#include "cli/end_request.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"

namespace concord {
namespace {

constexpr double kSync = 120.0;  // seconds, as all below
constexpr double kReplan = 5.0;
constexpr double kDrive = 180.0;
constexpr double kStuck = 10.0;  // without coming nearer
constexpr double kAgain = 0.2;
constexpr double kNearer = 0.05;  // metres
constexpr double kThere = 0.3;    // metres

}  // namespace

/// A simulated robot goes there itself; a map file has nobody who could.
DemoRun::Step DemoRun::drive_to_start() {
  if (!scene_.world || !scene_.start) return {};
  const double since = now();
  const auto path = plan(*scene_.start);
  if (!path) return tl::unexpected(path.error());
  say(scene_.agents.front().id + " drives to where it is asked to set out: " + to_words(*path));
  if (path->status == "OK" && !comes_to(*scene_.start)) say("it has not come there");
  took("drive_to_start", since);
  return {};
}

bool DemoRun::comes_to(const Eigen::Vector2d& goal) {
  const std::string& robot = scene_.agents.front().id;
  const auto left = [&] {
    const auto place = watch_->place(robot);
    return place ? (*place - goal).norm() : std::numeric_limits<double>::infinity();
  };
  double least = left(), since = now();
  live_->wait(kDrive, [&] {
    if (end_requested()) return true;
    if (left() < least - kNearer) std::tie(least, since) = std::pair(left(), now());
    return left() < kThere || now() - since > kStuck;
  });
  return left() < kThere;
}

/// A robot that drives is where it is; one that cannot is asked about all the same.
tl::expected<Path, Failure> DemoRun::plan(const Eigen::Vector2d& goal) {
  const double end = now() + kSync;
  for (;;) {
    PathRequest request;
    request.id = live_->new_id();
    request.robot = scene_.agents.front().id;
    if (!scene_.world) request.start = *scene_.start;
    request.goal = goal;
    request.keep_active = true;
    auto path = request_path(*live_, request);
    if (!path) return path;
    // The planner copies the map as we do; it may be a moment behind.
    if (path->map_revision >= copies_->map.revision() || now() > end || end_requested()) {
      active_path_ = request.id;
      return path;
    }
    live_->wait(kAgain, end_requested);
  }
}

DemoRun::Step DemoRun::plan_before() {
  if (!scene_.start) return {};
  const double since = now();
  set_out_ = watch_->track(scene_.agents.front().id).size();
  auto path = plan(*scene_.goal);
  if (!path) return tl::unexpected(path.error());
  took("path_before", since);
  say("before the edit: " + to_words(*path));
  report_.path_before = std::move(*path);
  return {};
}

DemoRun::Step DemoRun::edit() {
  before_edit_ = copies_->map.map();
  if (scene_.edit.empty()) return {};
  const double since = now();
  if (const Step added = person_->add(scene_.edit, scene_.resolution); !added) return added;
  const auto shown = wait_for("the edit in the map", kSync, [this] {
    return std::ranges::all_of(scene_.edit, [&](const VoxelIndex& v) {
      const LogOdds value = copies_->map.map().at(v);
      return is_known(value) && is_occupied(value);
    });
  });
  if (!shown) return shown;
  took("edit", since);
  say("a person pinned " + format_count(static_cast<std::int64_t>(scene_.edit.size())) + " voxels");
  return {};
}

DemoRun::Step DemoRun::plan_after() {
  if (!scene_.start || scene_.edit.empty()) return {};
  const double since = now();
  const std::int64_t first = report_.path_before->plan_number, revision = copies_->map.revision();
  const auto kept = [&] {
    const Path* latest = live_->path_for(active_path_);
    return latest != nullptr && latest->map_revision >= revision ? latest : nullptr;
  };
  const bool by_itself = live_->wait(kReplan, [&] { return kept() != nullptr; });
  auto path = by_itself ? tl::expected<Path, Failure>(*kept()) : plan(*scene_.goal);
  if (!path) return tl::unexpected(path.error());
  if (report_.path_before->status == "OK") report_.replanned = by_itself && path->plan_number > first;
  took("path_after", since);
  say("after the edit: " + to_words(*path));
  report_.path_after = std::move(*path);
  return {};
}

/// What the robot drove shows whether it was turned aside.
DemoRun::Step DemoRun::arrive() {
  const std::optional<Path>& path = report_.path_after ? report_.path_after : report_.path_before;
  if (!scene_.world || !path) return {};
  const double since = now();
  if (path->status == "OK") report_.arrived = comes_to(*scene_.goal);
  const std::vector<Eigen::Vector2d>& track = watch_->track(scene_.agents.front().id);
  report_.driven.assign(track.begin() + static_cast<std::ptrdiff_t>(std::min(set_out_, track.size())), track.end());
  if (const auto place = watch_->place(scene_.agents.front().id)) report_.driven.push_back(*place);
  took("drive", since);
  if (report_.arrived) say(*report_.arrived ? "the robot went that way, and is there" : "the robot did not get there");
  return {};
}

}  // namespace concord
