#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "align/cell_table.hpp"
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
/// A map of voxels says so itself, kept in blocks of 2 x 2 x 2. A cloud does not; but who sees a floor has seen that no
/// wall stands on it, so the space over each piece of floor is taken as free up to what hangs over it, or to the
/// height of a person.
class FreeSpace {
 public:
  FreeSpace() = default;
  [[nodiscard]] static FreeSpace known(const BrickMap& map, double resolution);
  /// @pre `surface` is z up.
  [[nodiscard]] static FreeSpace over_floors(const SurfaceLevel& surface);

  [[nodiscard]] bool contains(const Eigen::Vector3d& p) const;
  /// All of it in pieces, in a fixed order.
  [[nodiscard]] std::vector<FreeColumn> columns() const;
  /// Blocks of 2 x 2 x 2 voxels; none for what was taken from floors.
  [[nodiscard]] std::size_t block_count() const;

 private:
  struct Clearance {
    float low, high;
  };

  double cell_ = 0.0;                  // edge of a cell of table_
  CellTable table_;                    // bricks, or columns (z = 0)
  std::vector<std::uint64_t> blocks_;  // by brick, bit x + 4 y + 16 z
  std::vector<Clearance> clearances_;  // by column
};

}  // namespace concord
