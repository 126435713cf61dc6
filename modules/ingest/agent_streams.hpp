#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "bus/brick_stream.hpp"
#include "ingest/ingest.hpp"

namespace concord {

/// What ingest says of its agents: a brick stream `out/agent/AGENT` each. The stream of a removed agent goes on saying
/// that it has ended, so that who was not listening is told as well.
class AgentStreams {
 public:
  AgentStreams(Bus& bus, Counters& counters, double resolution, double bytes_per_second, std::size_t max_ended)
      : bus_(bus), counters_(counters), resolution_(resolution), pace_(bytes_per_second), max_ended_(max_ended) {}

  /// The agent is new, or changed. Its layer must stay where it is in memory until end().
  void tell(const std::string& id, const Agent& agent, const Change& change);
  /// A brick of it changed. @pre it was told.
  void touch(const std::string& id, BrickIndex index) { live_.at(id)->touch(index); }
  /// The agent is gone, now or in an earlier start of this process.
  void end(const std::string& id);

 private:
  [[nodiscard]] std::unique_ptr<BrickSender> make(const std::string& id, const BrickMap& layer,
                                                  std::int64_t incarnation);

  Bus& bus_;
  Counters& counters_;
  double resolution_;
  double pace_;
  std::size_t max_ended_;
  const BrickMap nothing_{};
  std::map<std::string, std::unique_ptr<BrickSender>> live_;
  std::deque<std::pair<std::string, std::unique_ptr<BrickSender>>> ended_;  ///< oldest first
};

}  // namespace concord
