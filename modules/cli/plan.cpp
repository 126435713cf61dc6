#include <memory>
#include <optional>

#include "cli/arguments.hpp"
#include "cli/command.hpp"
#include "cli/grid_file.hpp"
#include "cli/live.hpp"
#include "cli/map_file.hpp"
#include "cli/numbers.hpp"
#include "cli/overview.hpp"
#include "cli/report.hpp"
#include "planner/plan.hpp"

namespace concord {
namespace {

struct Options {
  std::string map, robot, from, to, out;
  std::vector<double> band;
  std::optional<double> radius;  ///< metres
};

struct Ends {
  std::optional<Eigen::Vector2d> from;
  Eigen::Vector2d to;
};

Result<Ends> parse_ends(const Options& options) {
  const auto to = parse_point(options.to);
  if (!to) return tl::unexpected(to.error());
  if (options.from.empty()) return Ends{std::nullopt, *to};
  return parse_point(options.from).map([&](const Eigen::Vector2d& from) { return Ends{from, *to}; });
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

Result<void> draw(const Options& options, const Terms& terms, const OctomapImport& loaded, const Ends& ends,
                  const Path& path) {
  Overview overview;
  overview.title = "Path";
  overview.subtitle = options.map + ", robot radius " + format_number(terms.radius, 2) + " m: " + path.message;
  overview.resolution = loaded.resolution;
  overview.cut = terms.zmax;
  overview.map = &loaded.map;
  overview.after = to_route(path);
  overview.start = ends.from;
  overview.goal = ends.to;
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

Outcome plan_on_file(const Options& options, const Ends& ends, const Common& common) {
  if (!ends.from) return fail(Exit::kUnusable, "USAGE", "on a map file plan needs --from");
  const Terms terms = terms_of(options, common.site());
  const auto loaded = load_map(options.map);
  if (!loaded) return fail(loaded.error());
  const auto grid = project_map(loaded->map, loaded->resolution, terms.zmin, terms.zmax, terms.free_share);
  if (!grid) return fail(grid.error());
  const Path path = to_path(plan(*grid, *ends.from, ends.to, terms.radius), terms.zmin);
  if (!options.out.empty()) {
    const auto drawn = draw(options, terms, *loaded, ends, path);
    if (!drawn) return fail(drawn.error());
  }
  return print_path(path, common);
}

Outcome plan_command(const Options& options, const Common& common) {
  const auto ends = parse_ends(options);
  if (!ends) return fail(ends.error());
  if (!options.map.empty()) return plan_on_file(options, *ends, common);
  if (options.robot.empty()) return fail(Exit::kUnusable, "USAGE", "plan needs --map FILE or --robot ID");
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
  CLI::App& command = program.add("plan", "a path for a round robot: on a map file, or from the running planner",
                                  [options](const Common& common) { return plan_command(*options, common); });
  auto* map = command.add_option("--map", options->map, ".bt or .ot; without it the running planner is asked");
  command.add_option("--robot", options->robot, "the robot whose pose and radius the planner uses")->excludes(map);
  command.add_option("--band", options->band, "zmin zmax, metres; with --map; without it the site file's")
      ->expected(2)
      ->needs(map);
  command.add_option("--from", options->from, "\"x y\"; without it the robot's last pose");
  command.add_option("--to", options->to, "\"x y\", map frame, metres")->required();
  command.add_option("--radius", options->radius, "of the robot, metres; without it the site file's")
      ->check(kRobotRadius);
  command.add_option("--out", options->out, "writes a picture (.png); with --map")->needs(map);
}

}  // namespace concord
