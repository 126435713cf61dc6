#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "network.hpp"
#include "process.hpp"

namespace concord::test {

/// The real processes, each on a host of its own, with their state and logs in a folder that goes with this object.
class Stack {
 public:
  /// `settings` is added to the site file.
  explicit Stack(Network& network, const std::string& settings = "");
  ~Stack();
  Stack(const Stack&) = delete;
  Stack& operator=(const Stack&) = delete;

  void start(const std::string& process);
  void start_all();
  /// By SIGKILL.
  void kill(const std::string& process);
  /// As Ctrl-C, all at once. @throws std::runtime_error unless every process ends with 0.
  void interrupt_all();
  [[nodiscard]] const Host& host(const std::string& process) const { return *hosts_.at(process); }

  /// Runs the client on a host to its end and returns what it printed. @throws std::runtime_error unless it exits with
  /// 0.
  std::string concord(const Host& from, const std::string& arguments) const;
  /// Starts the client beside the test.
  [[nodiscard]] Process start_concord(const Host& from, std::vector<std::string> arguments) const;

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// The last lines of every log, for a test that failed.
  [[nodiscard]] std::string logs() const;

 private:
  std::filesystem::path folder_;
  std::map<std::string, const Host*> hosts_;
  std::map<std::string, Process> running_;
};

}  // namespace concord::test
