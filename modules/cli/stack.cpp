#include "cli/stack.hpp"

namespace concord {
namespace {

std::filesystem::path output_of(const StackSpec& spec, const std::string& name) {
  return spec.output.empty() ? std::filesystem::path() : spec.output / (name + ".txt");
}

}  // namespace

Result<void> start_stack(Supervisor& supervisor, const StackSpec& spec) {
  if (!spec.log.empty()) {
    std::error_code error;
    const bool exists = std::filesystem::exists(spec.log, error);
    if (error) return refuse(Code::kIo, "cannot write " + spec.log.string() + ": " + error.message());
    if (exists) {
      return refuse(Code::kExists, spec.log.string() + " exists; name another log or remove it");
    }
    const auto started = supervisor.start({.name = "lcm-logger",
                                           .command = {"lcm-logger", "--quiet", "--lcm-url=" + spec.lcm_url, spec.log},
                                           .output = output_of(spec, "lcm-logger"),
                                           .restart = false});
    if (!started) return started;
  }
  for (const std::string name : kStackProcesses) {
    std::vector<std::string> command = {program_folder() / ("concord-" + name)};
    if (!spec.site_file.empty()) command.insert(command.end(), {"--site", spec.site_file});
    const auto started = supervisor.start({.name = name, .command = command, .output = output_of(spec, name)});
    if (!started) return started;
  }
  return {};
}

}  // namespace concord
