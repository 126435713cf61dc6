#include <memory>
#include <optional>

#include <nlohmann/json.hpp>

#include "bus/site.hpp"
#include "cli/arguments.hpp"
#include "cli/command.hpp"
#include "cli/grid_file.hpp"
#include "cli/live.hpp"
#include "cli/map_file.hpp"
#include "cli/overview.hpp"
#include "cli/page.hpp"
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

Result<void> draw(const Options& options, double radius, const OctomapImport& loaded, const Ends& ends,
                  const PlanResult& result) {
  Overview overview;
  overview.title = "Path";
  overview.subtitle = options.map + ", robot radius " + format_number(radius, 2) + " m. " + result.message;
  overview.resolution = loaded.resolution;
  overview.cut = options.band[1];
  overview.map = &loaded.map;
  overview.after = Overview::Route{name(result.reason), result.points, result.length};
  overview.start = ends.from;
  overview.goal = ends.to;
  const auto written = write_overview(overview, options.out);
  return written ? Result<void>{} : tl::unexpected(written.error());
}

Outcome plan_on_file(const Options& options, const Ends& ends, const Common& common) {
  if (options.band.size() != 2 || !ends.from) {
    return fail(Exit::kUnusable, "USAGE", "on a map file plan needs --band and --from");
  }
  const double radius = options.radius.value_or(Site{}.unlisted.radius);
  const auto loaded = load_map(options.map);
  if (!loaded) return fail(loaded.error());
  const auto grid =
      project_map(loaded->map, loaded->resolution, options.band[0], options.band[1], Site{}.planner.free_share);
  if (!grid) return fail(grid.error());
  const PlanResult result = plan(*grid, *ends.from, ends.to, radius);
  if (!options.out.empty()) {
    const auto drawn = draw(options, radius, *loaded, ends, result);
    if (!drawn) return fail(drawn.error());
  }
  nlohmann::json points = nlohmann::json::array();
  for (const auto& p : result.points) points.push_back({p.x(), p.y()});
  const bool found = result.reason == Reason::kOk;
  common.print({{"status", name(result.reason)},
                {"message", result.message},
                {"length", found ? nlohmann::json(result.length) : nlohmann::json()},
                {"least_clearance", found ? nlohmann::json(result.least_clearance) : nlohmann::json()},
                {"points", points}},
               found ? "path of " + format_number(result.length, 2) + " m, " + std::to_string(result.points.size()) +
                           " points, least clearance " + format_number(result.least_clearance, 2) + " m"
                     : std::string(name(result.reason)) + ": " + result.message);
  return found ? Exit::kDone : Exit::kNegative;
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
  command.add_option("--band", options->band, "zmin zmax, metres; with --map")->expected(2)->needs(map);
  command.add_option("--from", options->from, "\"x y\"; without it the robot's last pose");
  command.add_option("--to", options->to, "\"x y\", map frame, metres")->required();
  command.add_option("--radius", options->radius, "of the robot, metres; without it the site file's")
      ->check(CLI::Range(0.0, 10.0));
  command.add_option("--out", options->out, "writes a picture (.png); with --map")->needs(map);
}

}  // namespace concord
