#include "mapper/map_budget.hpp"

#include <algorithm>
#include <functional>

namespace concord::hmd {
namespace {

struct Use {
  std::size_t agents = 0, bytes = 0;
};

Use use_of(const std::vector<HeldMap>& held, const std::function<bool(const HeldMap&)>& counts) {
  Use use;
  for (const HeldMap& map : held) {
    if (!counts(map)) continue;
    ++use.agents;
    use.bytes += map.bytes;
  }
  return use;
}

/// @param full whether this is too much, of one identity or of all.
Leaving make_room(std::vector<HeldMap> held, const std::string& identity,
                  const std::function<bool(const Use&, bool of_one)>& full) {
  std::vector<std::string> leaving;
  const auto is_theirs = [&](const HeldMap& map) { return map.identity == identity; };
  for (;;) {
    const bool share_full = full(use_of(held, is_theirs), true);
    if (!share_full && !full(use_of(held, [](const HeldMap&) { return true; }), false)) return leaving;
    auto oldest = held.end();
    for (auto map = held.begin(); map != held.end(); ++map) {
      if (map->spoken_for || (share_full && !is_theirs(*map))) continue;
      if (oldest == held.end() || map->used < oldest->used) oldest = map;
    }
    if (oldest == held.end()) return std::nullopt;
    leaving.push_back(oldest->agent);
    held.erase(oldest);
  }
}

}  // namespace

Leaving room_for_agent(std::vector<HeldMap> held, const std::string& identity, const MapLimits& limits) {
  return make_room(std::move(held), identity, [&](const Use& use, bool of_one) {
    return use.agents >= (of_one ? limits.agents_of_one : limits.agents);
  });
}

Leaving room_for_look(std::vector<HeldMap> held, const std::string& identity, const MapLimits& limits) {
  return make_room(std::move(held), identity, [&](const Use& use, bool of_one) {
    return use.bytes >= (of_one ? limits.bytes_of_one : limits.bytes);
  });
}

}  // namespace concord::hmd
