#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/corrections.hpp"
#include "semantic/labels/outlines.hpp"

namespace concord {

/// Something labelled that robots keep away from.
struct KeptClearOf {
  std::string name;   ///< for people: class and number
  Outline outline;    ///< where it shows in the map; of at least a voxel
  double margin = 0;  ///< metres, above 0
  int cost = 0;       ///< 0: they keep out; else a metre there costs so many more
};

/// A no-go or costly zone around each thing: all ground within `margin` of its voxels, seen from above, over the
/// heights that it has. It is the polygon of 32 sides around that, so it fills what the thing is hollow of, and reaches
/// farther than it should by at most half a percent of the margin and a twentieth of the thing: on the safe side. Over
/// `most` things, those near to one another that cost the same share a zone, no fewer than must be,
/// and no-go zones only where those alone are too many. @pre `most` is
/// above Zone::kMaxCost
[[nodiscard]] std::vector<Zone> keep_out_zones(std::span<const KeptClearOf> things, double resolution,
                                               std::size_t most = kMaxZones);

}  // namespace concord
