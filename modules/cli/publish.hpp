#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "agent/submap_publisher.hpp"
#include "cli/live.hpp"

namespace concord {

/// What the stack says of an agent of which it is known what it sends. Must live as long as `live` handles messages.
class Delivery {
 public:
  /// Waits for `map`, at the site's resolution, in `frame`.
  Delivery(Live& live, const std::string& agent, const std::string& frame, const BrickMap& map);

  /// Ingest holds exactly the map, and merge all that ingest holds.
  [[nodiscard]] bool arrived() const { return held_ && taken_; }
  /// Grows with everything that comes in.
  [[nodiscard]] std::int64_t moves() const { return moves_; }
  /// How often ingest has refused something of this agent since something came in, and why at last.
  [[nodiscard]] std::int64_t refusals() const { return refusals_; }
  [[nodiscard]] const std::string& refusal() const { return refusal_; }
  /// Ingest could not write last.
  [[nodiscard]] bool disk_fails() const { return disk_fails_; }

 private:
  void on_digest(const BrickDigest& digest);
  void on_agents(const AgentList& list);
  void on_status(const ProcessStatus& status);
  void moved();

  std::string agent_, frame_;
  std::int64_t brick_count_;
  std::uint64_t content_;
  std::int64_t revision_ = 0;  ///< of ingest's stream
  std::int64_t known_ = -1;    ///< by merge
  std::uint64_t last_content_ = 0;
  bool held_ = false, taken_ = false;
  std::int64_t moves_ = 0;
  bool status_heard_ = false;
  std::map<std::string, std::int64_t> refused_;  ///< as ingest counted last
  std::int64_t refusals_ = 0;
  std::string refusal_;
  bool disk_fails_ = false;
};

/// A map file that plays a robot: its submap goes the way a robot's would.
class PublishedMap {
 public:
  /// `map` has the site's resolution. Speaks as soon as `live` handles messages, and must live as long as it does.
  PublishedMap(Live& live, const std::string& agent, const std::string& frame, const BrickMap& map);

  /// The stack has all of it, and nothing is left to send. What the agent sent before is no part of it any more.
  [[nodiscard]] bool arrived() const { return publisher_.idle() && delivery_.arrived(); }
  /// Changes while something is sent or comes in.
  [[nodiscard]] std::int64_t moves() const {
    return delivery_.moves() + (publisher_.idle() ? 0 : publisher_.bytes_sent());
  }
  [[nodiscard]] const Delivery& delivery() const { return delivery_; }
  /// A person reset this agent: what was sent is void.
  [[nodiscard]] bool was_reset() const { return was_reset_; }
  [[nodiscard]] std::int64_t known() const { return known_; }
  [[nodiscard]] std::int64_t bytes_sent() const { return publisher_.bytes_sent(); }

 private:
  std::int64_t known_;
  bool was_reset_ = false;
  Delivery delivery_;
  SubmapPublisher publisher_;
};

}  // namespace concord
