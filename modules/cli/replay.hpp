#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bus/log_reader.hpp"
#include "bus/site.hpp"
#include "cli/command.hpp"
#include "cli/stream_gaps.hpp"

namespace concord {

/// What a log's `in/` channels lead to.
struct Replayed {
  std::map<std::string, std::uint64_t> digests;  ///< see StackWatch
  std::vector<StreamGaps::Gap> gaps;
  std::optional<LogCut> cut;  ///< all whole events before it were played
  std::int64_t messages = 0;
  double seconds = 0;  ///< from the first to the last
  std::size_t map_bricks = 0;
};

/// Notes what a log holds while it is read.
class Reading {
 public:
  explicit Reading(double resolution) : resolution_(resolution) {}
  void hear(const LogEvent& event);
  /// Count, duration and gaps.
  void into(Replayed& replayed) const;

 private:
  double resolution_;
  std::optional<StreamGaps> gaps_;
  std::int64_t messages_ = 0, first_ = 0, last_ = 0;
};

/// Plays the log through the nodes in this process, on log time: the same log gives the same bytes every time.
/// State goes into a fresh folder; `site.state` and `site.lcm_url` are not used.
[[nodiscard]] tl::expected<Replayed, Failure> replay_lockstep(const std::filesystem::path& log, Site site);

/// Plays the log with the stock lcm-logplayer, at the speed it was recorded, into processes started for it on a port of
/// their own. Ends with the same map as `replay_lockstep`.
[[nodiscard]] tl::expected<Replayed, Failure> replay_live(const std::filesystem::path& log, Site site);

/// Reads a log from front to back: `take(event)` gets each message on an `in/` channel. Returns where the log is cut,
/// if it is. Refused: what LogReader refuses, a log whose clock jumped by more than a day, and one with nothing to take
/// (kEmpty).
[[nodiscard]] Result<std::optional<LogCut>> each_input(const std::filesystem::path& log,
                                                       const std::function<void(const LogEvent&)>& take);

void add_replay(Program& program);

}  // namespace concord
