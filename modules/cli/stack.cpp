#include "cli/stack.hpp"

namespace concord {
namespace {

std::filesystem::path output_of(const StackSpec& spec, const std::string& name) {
  return spec.output.empty() ? std::filesystem::path() : spec.output / (name + ".txt");
}

}  // namespace

Result<FileLock> start_stack(Supervisor& supervisor, const StackSpec& spec) {
  auto lock = FileLock::take(spec.state / "lock", "a stack runs on the state folder " + spec.state.string() +
                                                      " already; end that one first, or name another in the site file");
  if (!lock) return lock;
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
    if (!started) return tl::unexpected(started.error());
  }
  std::vector<std::string> names(std::begin(kStackProcesses), std::end(kStackProcesses));
  if (spec.bridge) names.emplace_back("hmd-bridge");
  for (const std::string& name : names) {
    std::vector<std::string> command = {program_folder() / ("concord-" + name)};
    if (!spec.site_file.empty()) command.insert(command.end(), {"--site", spec.site_file});
    const auto started = supervisor.start({.name = name, .command = command, .output = output_of(spec, name)});
    if (!started) return tl::unexpected(started.error());
  }
  return lock;
}

tl::unexpected<Failure> not_started(const Error& error) {
  return error.code == Code::kBusy ? fail(Exit::kRefused, name(error.code), error.message) : fail(error);
}

}  // namespace concord
