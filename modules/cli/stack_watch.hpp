#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "bus/brick_stream.hpp"
#include "bus/messages.hpp"

namespace concord {

/// Hears what a stack says until it has nothing more to say, and puts that in a few numbers.
class StackWatch {
 public:
  /// Must live as long as `bus` handles messages.
  StackWatch(Bus& bus, double resolution);

  /// All processes and streams have been heard.
  [[nodiscard]] bool awake() const;
  /// All streams are in sync and nothing has changed for 3 s, counted from `since` on.
  [[nodiscard]] bool quiet(std::int64_t since) const {
    return quiet_since_ != 0 && bus_.now() - std::max(quiet_since_, since) >= kQuiet;
  }

  /// Hashes over sorted keys and values, never revisions or times: of the map, the conflicts, the grid, the last path
  /// of each request, the answers.
  [[nodiscard]] std::map<std::string, std::uint64_t> digests() const;
  [[nodiscard]] std::size_t map_bricks() const { return map_.map.brick_count(); }

 private:
  static constexpr std::int64_t kQuiet = 3'000'000;
  static constexpr std::int64_t kLook = 100'000;

  struct Copy {
    Copy(StackWatch& watch, const std::string& stream, double resolution);
    BrickMap map;
    BrickReceiver receiver;
  };
  /// Whatever moves while there is work.
  using State = std::vector<std::int64_t>;

  template <class T, class Take>
  void hear(const std::string& channel_regex, Take take);
  void look();
  [[nodiscard]] bool synced() const;
  [[nodiscard]] State state() const;

  Bus& bus_;
  Counters counters_;
  Copy map_, conflicts_, grid_;
  std::map<std::string, Path> paths_;      ///< by request
  std::map<std::string, Answer> answers_;  ///< by request and process
  AgentList agents_;
  std::map<std::string, ProcessStatus> statuses_;
  std::int64_t messages_ = 0;
  State before_;
  std::int64_t quiet_since_ = 0;
};

}  // namespace concord
