#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "network.hpp"

namespace concord::soak {

struct Plan {
  int operations = 2000;
  int kills = 200;
  int authors = 8;
  int loss_per_mille = 0;  ///< of the UDP packets that arrive anywhere
  std::uint32_t seed = 1;
};

struct Outcome {
  std::int64_t acknowledged = 0;
  std::int64_t refused = 0;
  std::int64_t lost = 0;          ///< acknowledged, and not in the history afterwards
  std::int64_t half_applied = 0;  ///< in the history, but refused, never asked, or otherwise than it was asked
  bool equal_oracle = false;  ///< map, conflicts and zones, to the byte; twice: at the end, and after all was killed
  std::map<std::string, int> refusals;  ///< by code
  std::map<std::string, int> kills;     ///< by process
  std::vector<std::string> complaints;  ///< what was wrong, in words
  double seconds = 0;

  [[nodiscard]] bool good() const { return lost == 0 && half_applied == 0 && equal_oracle; }
};

/// Real processes on hosts of their own, people who edit, undo, fence off and re-align all at once, and a process
/// killed (SIGKILL) at random moments.
[[nodiscard]] Outcome run(const Plan& plan, test::Network& network);

}  // namespace concord::soak
