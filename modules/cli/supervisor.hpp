#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/error.hpp"

namespace concord {

/// A program that runs beside us.
struct ChildSpec {
  std::string name;
  std::vector<std::string> command;  ///< an executable's path, or a name looked up in PATH, and its arguments
  std::filesystem::path output;      ///< both its streams are appended there; empty: ours
  bool restart = true;               ///< false: it may end by itself
};

/// Starts programs, starts those that crash again, ends them all when it goes. Nothing stays behind: a child that
/// ignores SIGTERM is killed, and the kernel ends the children of a supervisor that was itself killed.
/// One thread; nothing happens between calls.
class Supervisor {
 public:
  using Clock = std::chrono::steady_clock;
  using Say = std::function<void(const std::string& line)>;

  /// A crashed child is started again after this long, twice as long each time, until it has run for kSteady.
  static constexpr std::chrono::milliseconds kFirstPause{200};
  static constexpr std::chrono::milliseconds kLongestPause{5000};
  static constexpr std::chrono::seconds kSteady{20};
  /// Between SIGTERM and SIGKILL.
  static constexpr std::chrono::milliseconds kGrace{5000};
  /// What a program answers that cannot use its configuration: another start would not help.
  static constexpr int kConfigurationExit = 2;

  explicit Supervisor(Say say) : say_(std::move(say)) {}
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;
  ~Supervisor() { stop(); }

  /// Refused: a program that cannot be started (kIo), a name that is taken (kExists).
  [[nodiscard]] Result<void> start(ChildSpec spec);
  /// Returns once a child has ended or a restart was due, at the latest after `patience`; does what there is to do.
  void wait(std::chrono::milliseconds patience);
  /// Ends one child, in order: SIGTERM, grace, SIGKILL.
  void stop(const std::string& name);
  /// Ends all, those started last first.
  void stop();

  /// 0 while it is not running.
  [[nodiscard]] pid_t pid(const std::string& name) const;
  [[nodiscard]] int restarts(const std::string& name) const;
  /// The exit code of a child that has ended for good; 128 + n after signal n.
  [[nodiscard]] std::optional<int> exit_code(const std::string& name) const;
  /// The first child that gave up on its configuration.
  [[nodiscard]] std::optional<std::string> unusable() const;

 private:
  struct Child {
    ChildSpec spec;
    pid_t pid = 0;
    int handle = -1;  ///< pidfd: readable once the process has ended
    int restarts = 0;
    std::chrono::milliseconds pause = kFirstPause;
    Clock::time_point since;
    std::optional<Clock::time_point> due;  ///< of the next start
    std::optional<int> exit_code;
  };

  [[nodiscard]] static Result<void> launch(Child& child);
  [[nodiscard]] static std::optional<int> reap(Child& child);
  static void end(Child& child);
  void on_end(Child& child, int code);
  void restart(Child& child);
  [[nodiscard]] const Child* find(const std::string& name) const;

  Say say_;
  std::vector<Child> children_;
};

/// The folder of the running program: where the stack's other programs are.
[[nodiscard]] std::filesystem::path program_folder();

}  // namespace concord
