#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/corrections.hpp"
#include "merge/layered_map.hpp"

namespace concord {

/// Where layers contradict each other and nobody has decided yet, by tile of the map (32 x 32 x 32 voxels).
struct ConflictReport {
  std::int64_t regions_in_all = 0;
  std::int64_t voxels_in_all = 0;
  std::vector<ConflictRegion> regions;  ///< most voxels first, then by tile
};

/// Lists at most `most` regions, with what each agent claims there; only for these are layers looked at. As of the
/// last refold.
[[nodiscard]] ConflictReport report_conflicts(const LayeredMap& map, std::size_t most);

}  // namespace concord
