#pragma once

#include <filesystem>

#include "bus/site.hpp"
#include "cli/supervisor.hpp"

namespace concord {

inline constexpr const char* kStackProcesses[] = {"ingest", "merge", "planner"};

/// What runs as one stack.
struct StackSpec {
  std::filesystem::path site_file;  ///< empty: defaults
  std::string lcm_url;              ///< of that site
  std::filesystem::path log;        ///< of everything said on the bus; empty: none
  std::filesystem::path output;     ///< folder for what each process prints; empty: on screen
};

/// Starts the stock logger, if asked for, and then the stack's processes under `supervisor`.
/// Refused: a program that is not beside this one, or a logger that is not installed (kIo); a log that exists
/// (kExists).
[[nodiscard]] Result<void> start_stack(Supervisor& supervisor, const StackSpec& spec);

}  // namespace concord
