#include <cstdio>
#include <memory>

#include "cli/command.hpp"
#include "cli/end_request.hpp"
#include "cli/stack.hpp"

namespace concord {
namespace {

Outcome up(const std::string& log, const Common& common) {
  const Site site = common.site();
  end_on_signals();
  Supervisor supervisor([](const std::string& line) { std::fprintf(stderr, "concord: %s\n", line.c_str()); });
  const auto started = start_stack(supervisor, {common.site_file, site.lcm_url, site.state, log, {}, true});
  if (!started) return not_started(started.error());
  while (!end_requested() && !supervisor.unusable()) supervisor.wait(std::chrono::milliseconds(500));
  if (const auto name = supervisor.unusable()) {
    return fail(Exit::kUnusable, "CONFIGURATION", *name + " cannot use its configuration: see what it printed");
  }
  return Exit::kDone;
}

}  // namespace

void add_up(Program& program) {
  auto log = std::make_shared<std::string>();
  program
      .add("up", "runs the stack until Ctrl-C; what crashes is started again",
           [log](const Common& common) { return up(*log, common); })
      .add_option("--log", *log, "records everything said on the bus with lcm-logger");
}

}  // namespace concord
