#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "view/block_store.hpp"

namespace concord::hmd {

/// What a client looks at: PROTOCOL.md, Levels. In the layer's frame, metres.
struct ViewRegion {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  std::vector<double> radii;  ///< rising, by level; 1 to kLevels
  std::optional<std::array<double, 2>> z;
  double resolution = 0.05;

  bool operator==(const ViewRegion&) const = default;
};

/// From the centre to the nearest point of the block's box; 0 inside.
[[nodiscard]] double distance_to(const ViewRegion& region, const BlockKey& key);
/// Whether the block is one of those that show the region. Of all blocks that hold a point exactly one is, at most.
[[nodiscard]] bool in_view(const ViewRegion& region, const BlockKey& key);

}  // namespace concord::hmd
