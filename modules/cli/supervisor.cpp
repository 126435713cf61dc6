#include "cli/supervisor.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace concord {
namespace {

/// In the child, between fork and exec: only async-signal-safe calls. Reports errno over `report` and never returns.
[[noreturn]] void become(char* const* arguments, int output, int report, pid_t parent) {
  setpgid(0, 0);  // a terminal's Ctrl-C reaches the supervisor alone, which then ends its children in order
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(0);  // it went before we could ask to be told
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE}) ::signal(signal, SIG_DFL);
  if (output >= 0) {
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
  }
  execvp(arguments[0], arguments);
  const int error = errno;
  [[maybe_unused]] const ssize_t written = write(report, &error, sizeof(error));
  _exit(127);
}

bool wait_readable(int handle, std::chrono::milliseconds patience) {
  pollfd item{handle, POLLIN, 0};
  return poll(&item, 1, static_cast<int>(patience.count())) > 0;
}

}  // namespace

Result<void> Supervisor::launch(Child& child) {
  std::vector<char*> arguments;
  for (std::string& argument : child.spec.command) arguments.push_back(argument.data());
  arguments.push_back(nullptr);

  int output = -1;
  if (!child.spec.output.empty()) {
    output = open(child.spec.output.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (output < 0) {
      return refuse(Code::kIo, "cannot write " + child.spec.output.string() + ": " + std::strerror(errno));
    }
  }
  int report[2];
  const pid_t parent = getpid();
  const pid_t pid = pipe2(report, O_CLOEXEC) == 0 ? fork() : -1;
  if (pid == 0) become(arguments.data(), output, report[1], parent);
  const int fork_error = errno;
  if (output >= 0) close(output);
  if (pid < 0) return refuse(Code::kIo, child.spec.name + ": cannot fork: " + std::strerror(fork_error));

  close(report[1]);
  int error = 0;
  const bool failed = read(report[0], &error, sizeof(error)) == sizeof(error);  // end of file once exec succeeded
  close(report[0]);
  if (failed) {
    waitpid(pid, nullptr, 0);
    return refuse(Code::kIo, "cannot start " + child.spec.command[0] + ": " + std::strerror(error));
  }
  child.pid = pid;
  child.handle = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
  child.since = Clock::now();
  child.due.reset();
  return {};
}

std::optional<int> Supervisor::reap(Child& child) {
  int status = 0;
  if (child.pid == 0 || waitpid(child.pid, &status, WNOHANG) != child.pid) return std::nullopt;
  if (child.handle >= 0) close(child.handle);
  child.handle = -1;
  child.pid = 0;
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

Result<void> Supervisor::start(ChildSpec spec) {
  if (find(spec.name) != nullptr) return refuse(Code::kExists, spec.name + " runs already");
  Child child;
  child.spec = std::move(spec);
  if (auto launched = launch(child); !launched) return launched;
  children_.push_back(std::move(child));
  return {};
}

void Supervisor::wait(std::chrono::milliseconds patience) {
  std::vector<pollfd> handles;
  Clock::time_point until = Clock::now() + patience;
  for (const Child& child : children_) {
    if (child.handle >= 0) handles.push_back({child.handle, POLLIN, 0});
    if (child.due) until = std::min(until, *child.due);
  }
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
  poll(handles.data(), handles.size(), static_cast<int>(std::max(left, std::chrono::milliseconds{0}).count()));
  for (Child& child : children_) {
    if (const std::optional<int> code = reap(child)) on_end(child, *code);
    if (child.due && *child.due <= Clock::now()) restart(child);
  }
}

void Supervisor::on_end(Child& child, int code) {
  const std::string how =
      code > 128 ? "was ended by signal " + std::to_string(code - 128) : "exited with " + std::to_string(code);
  if (!child.spec.restart) {
    child.exit_code = code;
    if (code != 0) say_(child.spec.name + " " + how);
    return;
  }
  if (code == kConfigurationExit) {
    child.exit_code = code;
    say_(child.spec.name + " cannot use its configuration; not started again");
    return;
  }
  if (Clock::now() - child.since >= kSteady) child.pause = kFirstPause;
  child.due = Clock::now() + child.pause;
  say_(child.spec.name + " " + how + "; starting it again in " + std::to_string(child.pause.count()) + " ms");
  child.pause = std::min(2 * child.pause, kLongestPause);
}

void Supervisor::restart(Child& child) {
  ++child.restarts;
  if (auto launched = launch(child); !launched) {
    say_(launched.error().message);
    child.due = Clock::now() + child.pause;
  }
}

void Supervisor::end(Child& child) {
  child.due.reset();
  if (child.pid == 0) return;
  const pid_t group = child.pid;
  kill(-group, SIGTERM);
  if (!wait_readable(child.handle, kGrace)) kill(-group, SIGKILL);
  wait_readable(child.handle, kGrace);
  kill(-group, SIGKILL);  // what it may have started itself
  child.exit_code = reap(child);
}

void Supervisor::stop(const std::string& name) {
  for (Child& child : children_) {
    if (child.spec.name == name) end(child);
  }
}

void Supervisor::stop() {
  for (auto child = children_.rbegin(); child != children_.rend(); ++child) end(*child);
}

const Supervisor::Child* Supervisor::find(const std::string& name) const {
  const auto child = std::ranges::find(children_, name, [](const Child& c) { return c.spec.name; });
  return child != children_.end() ? &*child : nullptr;
}

pid_t Supervisor::pid(const std::string& name) const {
  const Child* child = find(name);
  return child != nullptr ? child->pid : 0;
}

int Supervisor::restarts(const std::string& name) const {
  const Child* child = find(name);
  return child != nullptr ? child->restarts : 0;
}

std::optional<int> Supervisor::exit_code(const std::string& name) const {
  const Child* child = find(name);
  return child != nullptr ? child->exit_code : std::nullopt;
}

std::optional<std::string> Supervisor::unusable() const {
  for (const Child& child : children_) {
    if (child.spec.restart && child.exit_code == kConfigurationExit) return child.spec.name;
  }
  return std::nullopt;
}

std::filesystem::path program_folder() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

}  // namespace concord
