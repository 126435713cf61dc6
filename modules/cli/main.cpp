#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "cli/command.hpp"
#include "cli/replay.hpp"
#include "cli/semantic_commands.hpp"

int main(int argc, char** argv) {
  // Standard output is for what was asked for.
  spdlog::set_default_logger(spdlog::stderr_color_mt("concord"));
  spdlog::set_level(spdlog::level::warn);
  concord::Program program;
  concord::add_info(program);
  concord::add_merge(program);
  concord::add_project(program);
  concord::add_plan(program);
  concord::add_status(program);
  concord::add_agents(program);
  concord::add_edit(program);
  concord::add_history(program);
  concord::add_zones(program);
  concord::add_leases(program);
  concord::add_conflicts(program);
  concord::add_agent_corrections(program);
  concord::add_requests(program);
  concord::add_goals(program);
  concord::add_saved_maps(program);
  concord::add_align(program);
  concord::add_downsample(program);
  concord::add_publish(program);
  concord::add_map(program);
  concord::add_voxelize(program);
  concord::add_segment(program);
  concord::add_label(program);
  concord::add_labels(program);
  concord::add_assets(program);
  concord::add_things(program);
  concord::add_detect(program);
  concord::add_bridge_access(program);
  concord::add_up(program);
  concord::add_demo(program);
  concord::add_replay(program);
  return program.run(argc, argv);
}
