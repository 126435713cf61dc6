#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bus/messages.hpp"

namespace concord {

/// Where agents contradict each other, as people see it: merge lists conflicts by tiles of the map, whose borders mean
/// nothing to them.
struct Conflicts {
  std::int64_t voxels = 0;              ///< in the whole map
  std::vector<ConflictRegion> regions;  ///< the most voxels first, then by place
  bool all = true;                      ///< false: there are more, of tiles that were not listed
};

/// Joins regions of `parts` (at least one) whose boxes meet and that are between the same agents, as long as what comes
/// of it is at most kLongestRegion voxels along each axis: of a wall along a hall it should still be seen where it is.
[[nodiscard]] Conflicts joined(const std::vector<ConflictList>& parts);
inline constexpr int kLongestRegion = 2 * 32;

/// The first `most`; `resolution` turns voxels into metres.
[[nodiscard]] nlohmann::json to_json(const Conflicts& conflicts, std::size_t most, double resolution);
/// A table for a person.
[[nodiscard]] std::string to_words(const Conflicts& conflicts, std::size_t most, double resolution);

}  // namespace concord
