#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cli/demo_scene.hpp"
#include "cli/live.hpp"
#include "cli/publish.hpp"

namespace concord {

/// The clouds that ingest counted as lost, over all its starts: each counts from 0.
class LostClouds {
 public:
  void note(const ProcessStatus& ingest);
  [[nodiscard]] std::int64_t of(const std::string& agent) const;

 private:
  std::map<std::string, std::map<std::int64_t, std::int64_t>> counts_;  ///< by agent and start
};

/// What the bus says about the processes and agents of a demo. Must live as long as `live` handles messages.
class DemoWatch {
 public:
  DemoWatch(Live& live, const DemoScene& scene);

  /// An agent that is a map file begins to send. @pre agent.file
  void publish(Live& live, const DemoAgent& agent);

  /// Where the agent is in the map, and has been since it was first heard of, half a metre apart: map frame, metres.
  [[nodiscard]] std::optional<Eigen::Vector2d> place(const std::string& id) const;
  [[nodiscard]] const std::vector<Eigen::Vector2d>& track(const std::string& id) const { return tracks_.at(id); }

  /// The process has said that it runs.
  [[nodiscard]] bool runs(const std::string& process) const { return statuses_.contains(process); }
  /// Any process that runs.
  [[nodiscard]] std::optional<std::string> anyone() const;

  /// The latest that merge says of the agents.
  [[nodiscard]] const std::vector<AgentState>& agents() const { return agents_; }
  [[nodiscard]] const AgentState* state_of(const std::string& id) const;
  /// Until merge says so itself.
  void note_aligned(const std::string& id, const Transform& T_map_agent);

  /// Percent of its way, or of its file.
  [[nodiscard]] std::int64_t progress(const DemoAgent& agent) const;
  /// All of it is aligned, and it has sent all it has.
  [[nodiscard]] bool finished(const DemoAgent& agent) const;
  /// It sends clouds: those have no digest that could be compared.
  [[nodiscard]] bool sends_clouds(const DemoAgent& agent) const { return !streams_.at(agent.id).in; }
  /// What ingest says of it now includes all it had sent until then: `since` for clouds, when ingest had answered a
  /// question asked after the last of them. @pre finished(agent)
  [[nodiscard]] bool taken_in(const DemoAgent& agent, std::int64_t since) const;
  /// Revision of ingest's word on it.
  [[nodiscard]] std::int64_t revision(const DemoAgent& agent) const;
  /// Clouds that it sent and ingest never got.
  [[nodiscard]] std::int64_t clouds_lost(const DemoAgent& agent) const { return lost_.of(agent.id); }
  [[nodiscard]] std::int64_t bytes_sent(const DemoAgent& agent) const;

 private:
  /// The latest digests of what an agent says of itself, and ingest of it.
  struct Streams {
    std::optional<BrickDigest> in, out;
  };

  void note_done(const ProcessStatus& status);
  [[nodiscard]] std::int64_t counter(const DemoAgent& agent, const std::string& name) const;

  std::map<std::string, ProcessStatus> statuses_;
  LostClouds lost_;
  std::map<std::string, Streams> streams_;
  std::map<std::string, std::int64_t> done_;  ///< when a simulated agent first said that it had sent all
  std::vector<AgentState> agents_;
  std::map<std::string, Eigen::Vector2d> places_;
  std::map<std::string, std::vector<Eigen::Vector2d>> tracks_;  ///< of all agents of the scene
  std::map<std::string, std::unique_ptr<PublishedMap>> published_;
};

}  // namespace concord
