#include <memory>

#include "cli/command.hpp"
#include "cli/demo_run.hpp"

namespace concord {

void add_demo(Program& program) {
  auto options = std::make_shared<DemoOptions>();
  CLI::App& command =
      program.add("demo", "the whole stack at work: simulated agents in a warehouse, or two map files as agents",
                  [options](const Common& common) { return DemoRun(*options, common).run(); });
  command.add_option("--out", options->out, "folder for report.json, overview.png, map.bt, index.html, demo.lcm")
      ->capture_default_str();
  command.add_flag("--headless", options->headless, "ends with the report");
  auto* maps = command.add_option("--maps", options->maps, "two .bt or .ot files, sent as agents a and b")->expected(2);
  command.add_option("--transform", options->transform, "T_a_b as \"x y z qx qy qz qw\": b's points into a's frame")
      ->needs(maps);
  command.add_option("--from", options->from, "\"x y\", where a path is to begin: map frame, metres");
  command.add_option("--to", options->to, "\"x y\", where it is to end");
  command.add_option("--edit-box", options->edit_box, "\"x0 y0 z0 x1 y1 z1\": what a person pins occupied");
  command.add_option("--band", options->band, "zmin zmax of the planner's grid; without it the site file's")
      ->expected(2);
  command.add_option("--seed", options->seed, "of the warehouse")->excludes(maps)->capture_default_str();
  command.add_option("--speed", options->speed, "simulated seconds a second")
      ->excludes(maps)
      ->check(CLI::Range(0.1, 20.0))
      ->capture_default_str();
}

}  // namespace concord
