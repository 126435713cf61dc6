#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

#include "network.hpp"

namespace concord::test {

/// A real program on a host. It dies with this object, and with the test.
class Process {
 public:
  /// Its output goes to the end of `log`. @throws std::runtime_error when it cannot be started.
  Process(const Host& host, const std::vector<std::string>& command, const std::filesystem::path& log);
  ~Process();
  Process(Process&& other) noexcept;
  Process& operator=(Process&&) = delete;

  /// SIGKILL. Returns when it is gone.
  void kill();
  /// As Ctrl-C: SIGINT. Returns its exit code; 128 + signal when it died of one.
  int interrupt();
  /// Waits for its own end. Returns its exit code.
  int wait();
  /// Whether it still runs.
  [[nodiscard]] bool runs();

 private:
  pid_t id_ = -1;
};

}  // namespace concord::test
