#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace concord::hmd {

/// How much of what headsets scan is held, in all and for one identity.
struct MapLimits {
  std::size_t agents = 64, agents_of_one = 16;
  std::size_t bytes = std::size_t{1} << 30, bytes_of_one = std::size_t{1} << 29;
};

/// The map of one agent.
struct HeldMap {
  std::string agent, identity;  ///< who spoke for it last
  std::size_t bytes = 0;
  std::int64_t used = 0;    ///< last, microseconds
  bool spoken_for = false;  ///< some session is this agent, be it away for a while
};

/// Which maps go to make room; nothing: there is none. Maps that nobody speaks for go, the one used longest ago first:
/// who comes back to one sends the whole room again. A map that somebody scans into never goes for another's. Who has
/// used up the share of one identity makes room among its own.
using Leaving = std::optional<std::vector<std::string>>;
/// For one more agent.
[[nodiscard]] Leaving room_for_agent(std::vector<HeldMap> held, const std::string& identity, const MapLimits& limits);
/// For one more look, which may go over the bound by what one look adds.
[[nodiscard]] Leaving room_for_look(std::vector<HeldMap> held, const std::string& identity, const MapLimits& limits);

}  // namespace concord::hmd
