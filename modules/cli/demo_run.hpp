#pragma once

#include <memory>

#include "cli/demo_folder.hpp"
#include "cli/demo_person.hpp"
#include "cli/demo_report.hpp"
#include "cli/demo_scene.hpp"
#include "cli/demo_score.hpp"
#include "cli/demo_watch.hpp"
#include "cli/live.hpp"
#include "cli/stack.hpp"

namespace concord {

/// One demo from start to end: processes, agents, alignment, a path, an edit, the path again, a report.
class DemoRun {
 public:
  /// @throws ConfigError
  DemoRun(const DemoOptions& options, const Common& common);

  [[nodiscard]] Outcome run();

 private:
  using Step = tl::expected<void, Failure>;

  /// A stream per agent, the map and the conflicts, as anyone on the bus sees them.
  struct Copies {
    Copies(Live& live, const DemoScene& scene);
    StreamCopy map, conflicts;
    std::map<std::string, std::unique_ptr<StreamCopy>> agents;
  };

  Step prepare();
  Step start();
  Step enter_bridge();
  Step send();
  Step follow_mapping();
  Step plan_before();
  Step edit();
  Step plan_after();
  Step collect();
  Step tell();

  /// Fails when a person interrupts or a process cannot run.
  [[nodiscard]] Step check(const std::string& what) const;
  [[nodiscard]] Step wait_for(const std::string& what, double seconds, const std::function<bool()>& done);
  [[nodiscard]] Step align(const AgentState& state);
  /// Until the map holds all that the agents sent, which is saved as `name`.
  [[nodiscard]] Step settle(const std::string& name);
  /// Until ingest has taken in all that it was sent, and merge that.
  [[nodiscard]] Step all_taken_in();
  [[nodiscard]] tl::expected<std::int64_t, Failure> save(const std::string& name);
  [[nodiscard]] tl::expected<Path, Failure> plan();
  void note_moment();
  void say_progress() const;
  void score();
  void show();
  void say(const std::string& line) const;
  [[nodiscard]] double now() const;
  void took(const std::string& part, double since) { report_.seconds[part] = now() - since; }

  DemoOptions options_;
  DemoFolder folder_;
  Common common_;
  std::optional<FileLock> folder_lock_, stack_lock_;
  Supervisor::Clock::time_point began_ = Supervisor::Clock::now();
  DemoScene scene_;
  Supervisor supervisor_;
  std::unique_ptr<Live> live_;
  std::unique_ptr<Copies> copies_;
  std::unique_ptr<DemoWatch> watch_;
  std::unique_ptr<DemoPerson> person_;
  std::string active_path_;  ///< the request that is kept up to date
  std::vector<MappingMoment> moments_;
  BrickMap before_edit_;
  DemoReport report_;
};

}  // namespace concord
