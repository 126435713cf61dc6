#include "cli/command.hpp"

int main(int argc, char** argv) {
  concord::Program program;
  concord::add_info(program);
  concord::add_merge(program);
  concord::add_project(program);
  concord::add_plan(program);
  concord::add_status(program);
  concord::add_agents(program);
  concord::add_requests(program);
  concord::add_downsample(program);
  concord::add_publish(program);
  concord::add_map(program);
  concord::add_up(program);
  concord::add_demo(program);
  return program.run(argc, argv);
}
