#include "process.hpp"

#include <csignal>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace concord::test {
namespace {

/// Between fork and exec in a program with threads: only calls that are safe in a signal handler.
[[noreturn]] void become(char* const* arguments, int log) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  dup2(log, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  execv(arguments[0], arguments);
  _exit(127);
}

}  // namespace

Process::Process(const Host& host, const std::vector<std::string>& command, const std::filesystem::path& log) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file < 0) throw std::runtime_error("cannot write " + log.string());
  host.inside([&] {
    id_ = fork();
    if (id_ == 0) become(arguments.data(), file);
  });
  close(file);
  if (id_ < 0) throw std::runtime_error("cannot start " + command.front());
}

Process::Process(Process&& other) noexcept : id_(std::exchange(other.id_, -1)) {}

Process::~Process() { kill(); }

void Process::kill() {
  if (id_ < 0) return;
  ::kill(id_, SIGKILL);
  wait();
}

int Process::interrupt() {
  if (id_ >= 0) ::kill(id_, SIGINT);
  return wait();
}

int Process::wait() {
  if (id_ < 0) throw std::logic_error("the process has already been waited for");
  int status = 0;
  waitpid(id_, &status, 0);
  id_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

bool Process::runs() {
  return id_ >= 0 && waitid(P_PID, static_cast<id_t>(id_), nullptr, WEXITED | WNOHANG | WNOWAIT) == 0;
}

}  // namespace concord::test
