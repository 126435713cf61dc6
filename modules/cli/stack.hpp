#pragma once

#include <filesystem>

#include "bus/site.hpp"
#include "cli/command.hpp"
#include "cli/file_lock.hpp"
#include "cli/supervisor.hpp"

namespace concord {

inline constexpr const char* kStackProcesses[] = {"ingest", "merge", "align", "planner", "semantic"};

/// What runs as one stack.
struct StackSpec {
  std::filesystem::path site_file;  ///< empty: defaults
  std::string lcm_url;              ///< of that site, as the next
  std::filesystem::path state;
  std::filesystem::path log;     ///< of everything said on the bus; empty: none
  std::filesystem::path output;  ///< folder for what each process prints; empty: on screen
  bool bridge = false;           ///< whether headsets and browsers may come in
};

/// Starts the stock logger, if asked for, and then the stack's processes under `supervisor`.
/// @return what keeps other stacks off the state folder; hold it as long as the stack runs.
/// Refused: a stack runs on that state folder (kBusy); a program that is not beside this one, a logger that is not
/// installed, a folder that cannot be written (kIo); a log that exists (kExists).
[[nodiscard]] Result<FileLock> start_stack(Supervisor& supervisor, const StackSpec& spec);

/// kRefused where another one runs, else as fail().
[[nodiscard]] tl::unexpected<Failure> not_started(const Error& error);

}  // namespace concord
