#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>

#include "bus/messages.hpp"
#include "bus/process.hpp"

namespace concord {

/// Kept paths said in the frames of agents that asked for them (`path_watch_t`), on out/path_in/AGENT.
class WatchesNode {
 public:
  static constexpr std::size_t kMaxWatches = 256;
  static constexpr std::int64_t kHolds = 30'000'000;  ///< microseconds after it was asked last

  explicit WatchesNode(const NodeContext& context) : context_(context) {}

  /// Where agents lie now; true for each whose place is another than before: what is said in its frame is void.
  [[nodiscard]] std::set<std::string> set_agents(const AgentList& list);

  /// Whether it is watched from now on; the paths that it is about are to be said. Refused: kNotAligned, kBusy.
  [[nodiscard]] Result<void> watch(const PathWatch& watch);

  /// Says the path in every frame that it is watched in, or only in `agent`'s.
  void say(const Path& path, const std::string& agent = {});

 private:
  struct Placed {
    std::string frame_id;
    Transform T_map_agent;
  };

  NodeContext context_;
  std::map<std::string, Placed> placed_;  ///< the agents that are aligned
  /// By agent and robot (empty: all): until when.
  std::map<std::pair<std::string, std::string>, std::int64_t> watches_;
};

}  // namespace concord
