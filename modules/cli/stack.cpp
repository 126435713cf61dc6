#include "cli/stack.hpp"

#include <signal.h>

namespace concord {
namespace {

volatile sig_atomic_t end_was_requested = 0;

constexpr const char* kProcesses[] = {"ingest", "merge", "planner"};

std::filesystem::path output_of(const StackSpec& spec, const std::string& name) {
  return spec.output.empty() ? std::filesystem::path() : spec.output / (name + ".txt");
}

}  // namespace

Result<void> start_stack(Supervisor& supervisor, const StackSpec& spec) {
  if (!spec.log.empty()) {
    if (std::filesystem::exists(spec.log)) {
      return refuse(Code::kExists, spec.log.string() + " exists; name another log or remove it");
    }
    const auto started = supervisor.start({.name = "lcm-logger",
                                           .command = {"lcm-logger", "--quiet", "--lcm-url=" + spec.lcm_url, spec.log},
                                           .output = output_of(spec, "lcm-logger"),
                                           .restart = false});
    if (!started) return started;
  }
  for (const std::string name : kProcesses) {
    std::vector<std::string> command = {program_folder() / ("concord-" + name)};
    if (!spec.site_file.empty()) command.insert(command.end(), {"--site", spec.site_file});
    const auto started = supervisor.start({.name = name, .command = command, .output = output_of(spec, name)});
    if (!started) return started;
  }
  return {};
}

void end_on_signals() {
  struct sigaction action = {};
  action.sa_handler = [](int) { end_was_requested = 1; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool end_requested() { return end_was_requested != 0; }

}  // namespace concord
