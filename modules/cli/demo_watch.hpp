#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "cli/demo_scene.hpp"
#include "cli/live.hpp"
#include "cli/publish.hpp"

namespace concord {

/// What the bus says about the processes and agents of a demo. Must live as long as `live` handles messages.
class DemoWatch {
 public:
  explicit DemoWatch(Live& live);

  /// An agent that is a map file begins to send. @pre agent.file
  void publish(Live& live, const DemoAgent& agent);

  /// The process has said that it runs.
  [[nodiscard]] bool runs(const std::string& process) const { return statuses_.contains(process); }
  /// Any process that runs.
  [[nodiscard]] std::optional<std::string> anyone() const;

  /// The latest that merge says of the agents.
  [[nodiscard]] const std::vector<AgentState>& agents() const { return agents_; }
  [[nodiscard]] const AgentState* state_of(const std::string& id) const;
  /// Until merge says so itself.
  void note_aligned(const std::string& id);

  /// Percent of its way, or of its file.
  [[nodiscard]] std::int64_t progress(const DemoAgent& agent) const;
  /// All of it is aligned and with the stack.
  [[nodiscard]] bool finished(const DemoAgent& agent) const;
  [[nodiscard]] std::int64_t bytes_sent(const DemoAgent& agent) const;

 private:
  [[nodiscard]] std::int64_t counter(const DemoAgent& agent, const std::string& name) const;

  std::map<std::string, ProcessStatus> statuses_;
  std::vector<AgentState> agents_;
  std::map<std::string, std::unique_ptr<PublishedMap>> published_;
};

}  // namespace concord
