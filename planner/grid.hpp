#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/brick_map.hpp"
#include "core/error.hpp"
#include "planner/lattice/cell.hpp"

namespace concord {

/// The voxels whose centre lies in [zmin, zmax): those with first <= z < last.
struct Band {
  std::int32_t first = 0, last = 1;
  double floor = 0.0;    ///< zmin, metres
  double ceiling = 0.0;  ///< zmax, metres

  [[nodiscard]] std::int32_t height() const { return last - first; }
};

/// Refused: heights that are not finite, a band that holds no voxel centre, one beyond the lattice's bounds.
[[nodiscard]] Result<Band> make_band(double zmin, double zmax, double resolution);

/// What a projection changed in one column of bricks; bit x + 8 y is one cell.
struct ColumnChange {
  BrickIndex column;          ///< z = 0
  std::uint64_t blocked = 0;  ///< free before, not any more
  std::uint64_t freed = 0;    ///< free now, not before
};

/// The height band of a map as a grid: a cell is occupied if any voxel of the band above it is, else free if at least
/// `free_share` of the band's voxels were observed free, else unknown. Work follows the columns that are touched.
class Grid {
 public:
  /// @pre 0 < free_share <= 1, resolution > 0.
  Grid(double resolution, Band band, double free_share);

  /// Projects the columns of `touched` afresh. `touched` must name every brick that changed since the last call
  /// (removed ones too). Returns the columns whose cells changed, ascending.
  std::vector<ColumnChange> update(const BrickMap& map, std::span<const BrickIndex> touched);

  /// kUnknown, kFree or kOccupied.
  [[nodiscard]] LogOdds at(Cell cell) const { return cells_.at(VoxelIndex{cell.x, cell.y, 0}); }
  /// The cells as voxels with z = 0, kOccupied or kFree: what is streamed.
  [[nodiscard]] const BrickMap& cells() const { return cells_; }
  /// Cells of a column of bricks that are occupied by nothing but what people pinned; bit x + 8 y.
  [[nodiscard]] std::uint64_t pinned(BrickIndex column) const {
    const auto it = pinned_.find(column);
    return it != pinned_.end() ? it->second : 0;
  }
  /// A rectangle that holds all cells that were ever known; nothing outside it was observed.
  [[nodiscard]] const Window& seen() const { return seen_; }
  [[nodiscard]] bool has_pinned() const { return !pinned_.empty(); }
  [[nodiscard]] double resolution() const { return resolution_; }
  [[nodiscard]] const Band& band() const { return band_; }
  [[nodiscard]] double free_share() const { return free_share_; }

 private:
  struct Planes {
    std::uint64_t occupied = 0, free = 0;
    std::uint64_t pinned = 0;  ///< of the occupied ones, those that only people made so
  };

  [[nodiscard]] Planes project(std::span<const Tile* const> tiles, std::int32_t first_tile, int column) const;
  void see(BrickIndex column, std::uint64_t known);
  bool replace(BrickIndex column, const Planes& now, ColumnChange& change);

  double resolution_;
  Band band_;
  double free_share_;
  std::int32_t needed_;                                             ///< free voxels that make a cell free
  std::int32_t lowest_ = std::numeric_limits<std::int32_t>::max();  ///< bricks ever touched in the band, z
  std::int32_t highest_ = std::numeric_limits<std::int32_t>::min();
  BrickMap cells_;
  Window seen_{{kMaxVoxel, kMaxVoxel}, {-kMaxVoxel, -kMaxVoxel}};
  std::unordered_map<BrickIndex, std::uint64_t, IndexHash> pinned_;
};

/// Free cells of a column of the grid, and of any map whose cells are voxels with z = 0.
[[nodiscard]] std::uint64_t free_plane(const Brick* brick);

}  // namespace concord
