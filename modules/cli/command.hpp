#pragma once

#include <functional>
#include <string>

#include <CLI/App.hpp>
#include <nlohmann/json_fwd.hpp>

#include "bus/site.hpp"
#include "core/error.hpp"

namespace concord {

/// What `concord` answers its caller with; the table stands in README.md.
enum class Exit : int {
  kDone = 0,
  kNegative = 1,    ///< asked and answered, but: no path, a difference
  kUnusable = 2,    ///< usage, configuration, or a file that cannot be read or written
  kRefused = 3,     ///< the stack said no
  kIncomplete = 4,  ///< something did not arrive whole
  kNoAnswer = 5,    ///< nothing answered in time
};

/// Why a command ended without a result.
struct Failure {
  Exit exit = Exit::kUnusable;
  std::string code;  ///< a Code's name, or what the stack answered
  std::string message;
};

using Outcome = tl::expected<Exit, Failure>;

[[nodiscard]] inline tl::unexpected<Failure> fail(Exit exit, std::string code, std::string message) {
  return tl::unexpected<Failure>(Failure{exit, std::move(code), std::move(message)});
}
/// A refusal of our own, about what was given on the command line.
[[nodiscard]] inline tl::unexpected<Failure> fail(const Error& error) {
  return fail(Exit::kUnusable, name(error.code), error.message);
}

/// What all commands share.
struct Common {
  bool json = false;      ///< one JSON object on standard output instead of words
  std::string site_file;  ///< empty: defaults
  double timeout = 10.0;  ///< seconds to wait for an answer

  /// The site file's values, or the defaults. @throws ConfigError
  [[nodiscard]] Site site() const { return site_file.empty() ? Site{} : load_site(site_file); }

  /// Prints a result, in the form that was asked for.
  void print(const nlohmann::json& object, const std::string& words) const;
};

/// The commands of `concord`. Each file of this folder that holds one has a function `add_<command>(Program&)`.
class Program {
 public:
  using Run = std::function<Outcome(const Common&)>;

  Program();

  /// A new command; `run` is called once its arguments are there.
  CLI::App& add(const std::string& name, const std::string& what, Run run);

  /// Parses, runs the command that was named and says what came of it. @return the exit code.
  [[nodiscard]] int run(int argc, const char* const* argv);

 private:
  CLI::App app_;
  Common common_;
  Run chosen_;
};

void add_info(Program& program);
void add_merge(Program& program);
void add_project(Program& program);
void add_plan(Program& program);
void add_status(Program& program);
void add_agents(Program& program);
/// edit, undo, redo.
void add_edit(Program& program);
void add_history(Program& program);
/// zone, zones.
void add_zones(Program& program);
/// lease, leases.
void add_leases(Program& program);
void add_conflicts(Program& program);
/// set-weight, localise.
void add_agent_corrections(Program& program);
/// goal, paths.
void add_goals(Program& program);
/// set-transform, reset, remove.
void add_requests(Program& program);
/// save, load, maps.
void add_saved_maps(Program& program);
/// align, alignment, alignments.
void add_align(Program& program);
void add_downsample(Program& program);
void add_publish(Program& program);
/// map, digest.
void add_map(Program& program);
/// token, cert: who may come in through the bridge, and how it proves who it is.
void add_bridge_access(Program& program);
void add_up(Program& program);
void add_demo(Program& program);

}  // namespace concord
