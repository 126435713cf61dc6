#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "align/block_set.hpp"
#include "align/surface_level.hpp"
#include "core/brick_map.hpp"

namespace concord {

/// A place seen from above and how much of it is free.
struct FreeColumn {
  Eigen::Vector3f p;  ///< middle of the piece of free space, metres, frame of the map
  float height;       ///< metres
  float area;         ///< square metres
};

/// Where a map saw that nothing is.
///
/// A map of voxels says so itself. A cloud does not; but who saw two pieces of surface that face each other, and
/// nothing on the straight line between them, has seen that nothing is there; and who saw a floor, that no wall stands
/// on it.
class ObservedFreeSpace {
 public:
  ObservedFreeSpace() = default;
  [[nodiscard]] static ObservedFreeSpace known(const BrickMap& map, double resolution);
  /// What a surface lets one conclude. @pre z up.
  [[nodiscard]] static ObservedFreeSpace implied(const SurfaceLevel& surface, int threads);

  /// Of the map as a mirror in the plane x = 0 shows it.
  [[nodiscard]] ObservedFreeSpace mirrored() const;

  [[nodiscard]] bool contains(const Eigen::Vector3d& p) const;
  /// All of it in pieces, in a fixed order.
  [[nodiscard]] std::vector<FreeColumn> columns() const;
  [[nodiscard]] std::size_t block_count() const;

 private:
  double block_ = 0.0;      // metres: two voxels, or a cell of a surface
  double per_metre_ = 0.0;  // blocks
  BlockSet blocks_;
};

}  // namespace concord
