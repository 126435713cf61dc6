#include <tuple>
#include <utility>

#include <CLI/CLI.hpp>

#include "planner/planner_node.hpp"

int main(int argc, char** argv) {
  using concord::NodeContext;
  using concord::PlannerNode;
  using concord::Site;
  return concord::run_process(
      "planner", argc, argv,
      [](const NodeContext& context) -> std::shared_ptr<void> {
        return std::make_shared<PlannerNode>(context, std::launch::async);
      },
      [](CLI::App& app, Site& site) {
        app.add_option_function<std::pair<double, double>>(
               "--band",
               [&site](const std::pair<double, double>& band) {
                 std::tie(site.planner.zmin, site.planner.zmax) = band;
               },
               "height band that is projected, map z in metres; overrides the site file")
            ->type_name("ZMIN ZMAX");
      });
}
