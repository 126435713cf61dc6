#include <memory>
#include <optional>

#include <nlohmann/json.hpp>

#include "cli/arguments.hpp"
#include "cli/command.hpp"
#include "cli/live.hpp"
#include "cli/map_file.hpp"
#include "cli/numbers.hpp"
#include "cli/overview.hpp"
#include "cli/plan_footprint.hpp"
#include "cli/plan_ground.hpp"
#include "cli/plan_scenario.hpp"
#include "cli/report.hpp"
#include "planner/plan.hpp"

namespace concord {
namespace {

struct Options {
  std::string map, grid, robot, from, to, out, paths, footprint;
  std::optional<double> turn_radius;  ///< metres
  std::string scenario;
  bool any_angle = false, clearance = false;
  std::vector<double> band;
  std::optional<double> radius;  ///< metres
};

struct Ends {
  std::optional<Eigen::Vector2d> from;
  Eigen::Vector2d to;
};

/// A round robot is as well off in one direction as in another: the yaw that a pose may have is only checked.
Result<Eigen::Vector2d> parse_place(const std::string& text) {
  if (const auto pose = parse_numbers(text, 3)) return Eigen::Vector2d((*pose)[0], (*pose)[1]);
  return parse_point(text);
}

Result<Ends> parse_ends(const Options& options) {
  const auto to = parse_place(options.to);
  if (!to) return tl::unexpected(to.error());
  if (options.from.empty()) return Ends{std::nullopt, *to};
  return parse_place(options.from).map([&](const Eigen::Vector2d& from) { return Ends{from, *to}; });
}

/// What a plan on a file is held against: the site's where the command line is silent.
struct Terms {
  double zmin, zmax, radius, free_share;
};

Terms terms_of(const Options& options, const Site& site) {
  const bool own_band = !options.band.empty();
  return {own_band ? options.band[0] : site.planner.zmin, own_band ? options.band[1] : site.planner.zmax,
          options.radius.value_or(site.unlisted.radius), site.planner.free_share};
}

Result<Ground2D> load_ground(const Options& options, const Terms& terms) {
  return options.grid.empty() ? ground_of_map(options.map, terms.zmin, terms.zmax, terms.free_share)
                              : ground_of_grid(options.grid);
}

Result<void> draw(const Options& options, const Terms& terms, const Ground2D& ground, const Ends& ends,
                  const Path& path) {
  Overview overview;
  overview.title = "Path";
  overview.subtitle = (options.grid.empty() ? options.map : options.grid) + ", robot radius " +
                      format_number(terms.radius, 2) + " m: " + path.message;
  overview.resolution = ground.grid.resolution();
  overview.cut = terms.zmax;
  overview.map = &ground.map;
  overview.after = to_route(path);
  for (Eigen::Vector2d& p : overview.after->points) p -= ground.origin;
  overview.start = *ends.from - ground.origin;
  overview.goal = ends.to - ground.origin;
  const auto written = write_overview(overview, options.out);
  return written ? Result<void>{} : tl::unexpected(written.error());
}

/// As the planner would say it.
Path to_path(PlanResult result, double floor) {
  Path path;
  path.status = name(result.reason);
  path.message = std::move(result.message);
  for (const Eigen::Vector2d& p : result.points) path.points.emplace_back(p.x(), p.y(), floor);
  path.length = result.length;
  path.least_clearance = result.least_clearance;
  return path;
}

/// For other people's validators.
std::string to_line(const Path& path, double radius) {
  nlohmann::json line{{"query", 0}, {"status", path.status}, {"radius", radius}};
  if (path.status == "OK") {
    nlohmann::json points = nlohmann::json::array();
    for (const Eigen::Vector3d& p : path.points) points.push_back({p.x(), p.y()});
    line["length"] = path.length;
    line["least_clearance"] = path.least_clearance;
    line["points"] = std::move(points);
  }
  return line.dump() + '\n';
}

Outcome plan_on_file(const Options& options, const Ends& ends, const Common& common) {
  if (!ends.from) return fail(Exit::kUnusable, "USAGE", "on a file plan needs --from");
  const Terms terms = terms_of(options, common.site());
  const auto ground = load_ground(options, terms);
  if (!ground) return fail(ground.error());
  PlanResult result = plan(ground->grid, *ends.from - ground->origin, ends.to - ground->origin, terms.radius);
  for (Eigen::Vector2d& p : result.points) p += ground->origin;
  const Path path = to_path(std::move(result), terms.zmin);
  if (!options.paths.empty()) {
    const auto written = write_file(options.paths, to_line(path, terms.radius));
    if (!written) return fail(written.error());
  }
  if (!options.out.empty()) {
    const auto drawn = draw(options, terms, *ground, ends, path);
    if (!drawn) return fail(drawn.error());
  }
  return print_path(path, common);
}

Outcome plan_for_footprint(const Options& options, const Common& common) {
  if (options.from.empty() || options.to.empty())
    return fail(Exit::kUnusable, "USAGE", "a path for a footprint needs --from and --to");
  const Terms terms = terms_of(options, common.site());
  const auto ground = load_ground(options, terms);
  if (!ground) return fail(ground.error());
  FootprintOptions asked{options.from,
                         options.to,
                         options.footprint,
                         options.turn_radius.value_or(0),
                         options.paths,
                         options.out,
                         options.grid.empty() ? options.map : options.grid,
                         terms.zmax};
  return plan_footprint(asked, *ground, common);
}

Outcome plan_queries(const Options& options, const Common& common) {
  ScenarioOptions scenario{options.map, options.scenario, options.paths};
  if (options.any_angle) scenario.method = Method::kAnyAngle;
  if (options.clearance) scenario.method = Method::kClearance;
  return plan_scenario(scenario, common);
}

Outcome plan_command(const Options& options, const Common& common) {
  if (!options.scenario.empty()) return plan_queries(options, common);
  if (!options.footprint.empty()) return plan_for_footprint(options, common);
  if (options.to.empty()) return fail(Exit::kUnusable, "USAGE", "plan needs --to, or --map M.map --scen S.scen");
  const auto ends = parse_ends(options);
  if (!ends) return fail(ends.error());
  if (!options.map.empty() || !options.grid.empty()) return plan_on_file(options, *ends, common);
  if (!options.out.empty() || !options.paths.empty()) {
    return fail(Exit::kUnusable, "USAGE", "--picture and --paths need --map FILE or --grid FILE");
  }
  if (options.robot.empty()) return fail(Exit::kUnusable, "USAGE", "plan needs --map FILE, --grid FILE or --robot ID");
  PathRequest request;
  request.robot = options.robot;
  request.start = ends->from;
  request.goal = ends->to;
  request.radius = options.radius.value_or(0.0);
  return ask_path(std::move(request), common);
}

}  // namespace

void add_plan(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add("plan", "a path: on a map file, or from the running planner",
                                  [options](const Common& common) { return plan_command(*options, common); });
  auto* map = command.add_option("--map", options->map, ".bt or .ot; with --scen a .map of movingai.com");
  auto* grid = command.add_option("--grid", options->grid, "map_server's .yaml")->excludes(map);
  auto* scenario =
      command.add_option("--scen", options->scenario, "asks all queries of a .scen, times them")->needs(map);
  command.add_option("--paths", options->paths, "writes the paths found, one JSON a line; with --map or --grid");
  auto* any_angle = command.add_flag("--any-angle", options->any_angle, "the shortest at any angle")->needs(scenario);
  command.add_flag("--clearance", options->clearance, "keeping away from walls")->needs(scenario)->excludes(any_angle);
  command.add_option("--robot", options->robot, "the robot whose pose and radius the planner uses")
      ->excludes(map)
      ->excludes(grid);
  command.add_option("--band", options->band, "zmin zmax, metres; with --map; without it the site file's")
      ->expected(2)
      ->needs(map);
  command.add_option("--from", options->from, "\"x y\" or \"x y yaw\"; without it the robot's last pose")
      ->excludes(scenario);
  command.add_option("--to", options->to, "\"x y\" or \"x y yaw\", map frame, metres")->excludes(scenario);
  auto* radius = command.add_option("--radius", options->radius, "of the robot, metres; without it the site file's")
                     ->check(kRobotRadius);
  auto* footprint =
      command.add_option("--footprint", options->footprint,
                         "\"1.2x0.8\" or corners \"x y, x y, x y\", metres, x ahead; with --map or --grid");
  footprint->excludes(radius)->excludes(scenario)->excludes("--robot");
  command.add_option("--turn-radius", options->turn_radius, "metres; without it the footprint turns in place")
      ->needs(footprint);
  command.add_option("--out,--picture", options->out, "writes a picture (.png); with --map or --grid")
      ->excludes(scenario);
}

}  // namespace concord
