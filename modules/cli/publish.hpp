#pragma once

#include <functional>
#include <memory>
#include <string>

#include "agent/submap_publisher.hpp"
#include "cli/live.hpp"

namespace concord {

/// A map file that plays a robot: its submap goes the way a robot's would.
class PublishedMap {
 public:
  /// `map` has the site's resolution. Speaks as soon as `live` handles messages, and must live as long as it does.
  PublishedMap(Live& live, const std::string& agent, const std::string& frame, const BrickMap& map);

  /// Whether the stack has all of it, by the last list of agents.
  [[nodiscard]] bool arrived() const { return arrived_; }
  /// A person reset this agent: what was sent is void.
  [[nodiscard]] bool was_reset() const { return was_reset_; }
  [[nodiscard]] std::int64_t known() const { return known_; }
  [[nodiscard]] std::int64_t bytes_sent() const { return publisher_.bytes_sent(); }

 private:
  std::int64_t known_;
  bool arrived_ = false;
  bool was_reset_ = false;
  SubmapPublisher publisher_;
};

}  // namespace concord
