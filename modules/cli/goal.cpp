// goal, cancel, paths: where robots are sent, and the paths that the planner keeps up to date.

#include <memory>

#include <nlohmann/json.hpp>

#include "cli/arguments.hpp"
#include "cli/live.hpp"
#include "cli/numbers.hpp"
#include "cli/paths.hpp"
#include "cli/report.hpp"
#include "cli/table.hpp"

namespace concord {
namespace {

/// The planner says every path that it keeps, and its status, once a second.
constexpr double kListen = 2.5;

struct Goal {
  std::string robot, from;
  std::vector<double> to;
  std::vector<std::string> via;
  double radius = 0.0;        ///< 0: the site file's
  std::optional<double> yaw;  ///< of a robot with a footprint, at the goal
};

Outcome goal(const Goal& goal, const Common& common) {
  PathRequest request;
  request.robot = goal.robot;
  request.goal = {goal.to[0], goal.to[1]};
  request.radius = goal.radius;
  request.goal_yaw = goal.yaw;
  request.keep_active = true;
  if (!goal.from.empty()) {
    const auto from = parse_point(goal.from);
    if (!from) return fail(from.error());
    request.start = *from;
  }
  for (const std::string& place : goal.via) {
    const auto waypoint = parse_point(place);
    if (!waypoint) return fail(waypoint.error());
    request.waypoints.push_back(*waypoint);
  }
  return ask_path(std::move(request), common);
}

Outcome cancel(const std::string& robot, const Common& common) {
  if (!is_name(robot)) return bad_name(robot);
  Live live(common);
  PathRequest request;
  request.id = live.new_id();
  request.robot = robot;
  request.op = PathRequest::Op::kCancel;
  const auto answer = live.ask("in/path_request", request);
  if (!answer) return tl::unexpected(answer.error());
  common.print(to_json(*answer), answer->message);
  return Exit::kDone;
}

/// Has the planner say its paths in an agent's frame for a while.
tl::expected<void, Failure> watch(Live& live, const std::string& frame) {
  const auto answer = live.ask("in/path_watch", PathWatch{live.new_id(), "", frame});
  return answer ? tl::expected<void, Failure>() : tl::unexpected(answer.error());
}

Outcome paths(const std::string& frame, const Common& common) {
  if (!frame.empty() && !is_name(frame)) return bad_name(frame);
  Live live(common);
  KeptPaths kept;
  bool has_planner = false;
  live.hear<Path>(frame.empty() ? "out/path/.*" : "out/path_in/" + frame,
                  [&](const std::string&, const Path& path) { take(kept, path); });
  live.hear<ProcessStatus>("out/status/planner", [&](const std::string&, const ProcessStatus&) { has_planner = true; });
  if (!frame.empty()) {
    if (const auto watched = watch(live, frame); !watched) return tl::unexpected(watched.error());
  }
  live.wait(kListen, [] { return false; });
  if (!has_planner) return live.no_answer("the planner");
  common.print(to_json(kept), to_words(kept));
  return Exit::kDone;
}

}  // namespace

void take(KeptPaths& kept, const Path& path) {
  if (path.active) {
    kept[path.robot] = path;
    return;
  }
  // An answer to a question leaves the kept path alone.
  const auto it = kept.find(path.robot);
  if (it != kept.end() && it->second.id == path.id) kept.erase(it);
}

nlohmann::json to_json(const KeptPaths& kept) {
  nlohmann::json array = nlohmann::json::array();
  for (const auto& [robot, path] : kept) {
    nlohmann::json object = to_json(path);
    object["robot"] = robot;
    object["id"] = path.id;
    array.push_back(std::move(object));
  }
  return {{"paths", array}};
}

std::string to_words(const KeptPaths& kept) {
  if (kept.empty()) return "no path is kept up to date; concord goal asks for one";
  std::vector<std::vector<std::string>> rows = {{"robot", "state", "to: x, y (m)", "length (m)", "planned", "id", ""}};
  for (const auto& [robot, path] : kept) {
    const bool found = path.status == "OK" && !path.points.empty();
    rows.push_back(
        {robot, path.status,
         found ? format_number(path.points.back().x(), 2) + "  " + format_number(path.points.back().y(), 2) : "",
         found ? format_number(path.length, 2) : "", std::to_string(path.plan_number + 1) + " times", path.id,
         found ? "" : path.message});
  }
  return format_table(rows, "lllrrll");
}

Outcome ask_path(PathRequest request, const Common& common) {
  if (!is_name(request.robot)) return bad_name(request.robot);
  if (!request.goal.allFinite()) return fail(Exit::kUnusable, "NOT_FINITE", "the goal must be two finite numbers");
  Live live(common);
  request.id = live.new_id();
  const auto path = request_path(live, request);
  if (!path) return tl::unexpected(path.error());
  return print_path(*path, common);
}

void add_goals(Program& program) {
  auto options = std::make_shared<Goal>();
  CLI::App& go = program.add(
      "goal", "sends a robot's path, and keeps it up to date as the map changes, until the robot's next goal",
      [options](const Common& common) { return goal(*options, common); });
  go.add_option("robot", options->robot, "the robot's id")->required();
  go.add_option("goal", options->to, "x y, map frame, metres")->expected(2)->required();
  go.add_option("--yaw", options->yaw,
                "where a robot with a footprint is to point there, radians; without it anywhere");
  go.add_option("--from", options->from,
                "\"x y\", map frame; without it the robot's last pose, also when planned anew");
  go.add_option("--via", options->via, "\"x y\", map frame, metres: a place to pass first; may be given again");
  go.add_option("--radius", options->radius, "of the robot, metres; without it the site file's")->check(kRobotRadius);

  auto robot = std::make_shared<std::string>();
  program
      .add("cancel", "ends the path that the planner keeps for a robot, and what waits for it",
           [robot](const Common& common) { return cancel(*robot, common); })
      .add_option("robot", *robot, "the robot's id")
      ->required();

  auto frame = std::make_shared<std::string>();
  program
      .add("paths", "the paths that the planner keeps up to date",
           [frame](const Common& common) { return paths(*frame, common); })
      .add_option("--frame", *frame, "in the frame of this agent, which must be aligned; without it the map's");
}

}  // namespace concord
