#include "cli/end_request.hpp"

#include <signal.h>

namespace concord {
namespace {

volatile sig_atomic_t end_was_requested = 0;

}  // namespace

void end_on_signals() {
  struct sigaction action = {};
  action.sa_handler = [](int) { end_was_requested = 1; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool end_requested() { return end_was_requested != 0; }

}  // namespace concord
