#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

#include "core/brick_map.hpp"
#include "protocol/frame.hpp"

namespace concord::hmd {

/// What a headset has scanned, as voxels in its own frame.
///
/// Mesh looks follow SLAM-XR's voxelizer (Section III-A): each look adds 5 % to every cell that a mesh meets and takes
/// 1 % off every existing voxel that none meets; a voxel exists from 60 % up. Cells begin at 50 %, and only those
/// within kReach of the sensor are judged. Free space is HAC-SLAM's Algorithm 1 with an exact traversal (core/ray.hpp):
/// a ray from the sensor to a met cell frees the cells before the first that is met, and never that one.
class RoomMapper {
 public:
  static constexpr int kBegin = 50, kHit = 5, kMiss = 1, kExists = 60, kFull = 100;  ///< percent
  static constexpr double kReach = 5.0;                                              ///< metres
  static constexpr std::size_t kMaxCells = 4'000'000;                                ///< that all meshes meet
  static constexpr std::size_t kMaxLookCells =
      2'000'000;                                  ///< that are looked at for the triangles of one look, each time
  static constexpr std::size_t kMaxRays = 2'000;  ///< of one look; of more met cells each n-th, in turns
  static constexpr std::size_t kMaxBricks = 200'000;
  static constexpr std::size_t kMaxMeshes = 4096;
  static constexpr std::size_t kBrickBytes = 1100;  ///< of memory that a brick takes at most, about

  explicit RoomMapper(double resolution) : resolution_(resolution) {}

  /// Refused, and nothing has changed: meshes or a map larger than the limits (kTooLarge), a sensor or mesh beyond any
  /// map (kOutOfBounds), a sequence that came before (kStale), a first one above 0 (kBadFrame): what comes first is the
  /// whole room, and a part of it would take the place of the whole that others still have.
  [[nodiscard]] Result<void> take(const MeshLook& look, std::int64_t sequence);
  /// Refused also: another resolution (kBadResolution), no voxel (kEmpty).
  [[nodiscard]] Result<void> take(const VoxelLook& look, std::int64_t sequence);
  /// The sequence begins anew, with the whole room: meshes are met no more unless they come again. What they made of
  /// the map stays, and goes as what none meets.
  void end_sequence();

  [[nodiscard]] const BrickMap& map() const { return map_; }
  /// Bricks that have changed since the last call, ascending.
  [[nodiscard]] std::vector<BrickIndex> take_changed();
  [[nodiscard]] std::int64_t occupied() const { return occupied_; }
  /// Of memory, about.
  [[nodiscard]] std::size_t bytes() const {
    return cells_.size() * kCellsBytes + map_.brick_count() * kBrickBytes + met_cells_ * sizeof(VoxelIndex);
  }
  [[nodiscard]] std::int64_t known() const { return static_cast<std::int64_t>(map_.known_count()); }

 private:
  /// By voxel: 0 unknown, 1 free, from kBegin on percent.
  using Cells = std::array<std::uint8_t, kBrickVoxels>;
  static constexpr std::uint8_t kUnknownCell = 0, kFreeCell = 1;
  static constexpr std::size_t kCellsBytes = sizeof(Cells) + 40;

  [[nodiscard]] Result<std::vector<VoxelIndex>> cells_of(const MeshPart& part, std::size_t& budget) const;
  void judge(const std::unordered_map<BrickIndex, VoxelMask, IndexHash>& met, const Eigen::Vector3d& sensor);
  void cast(const std::unordered_map<BrickIndex, VoxelMask, IndexHash>& met, const std::vector<VoxelIndex>& ends,
            const Eigen::Vector3d& sensor);
  void render(BrickIndex index);
  [[nodiscard]] bool reached(VoxelIndex voxel, const Eigen::Vector3d& sensor) const;

  double resolution_;
  std::int64_t next_sequence_ = 0;
  std::map<std::uint32_t, std::vector<VoxelIndex>> meshes_;  ///< cells that each meets, sorted
  std::size_t met_cells_ = 0;
  std::unordered_map<BrickIndex, Cells, IndexHash> cells_;
  BrickMap map_;
  std::int64_t occupied_ = 0;
  std::map<BrickIndex, bool> changed_;  ///< true: not rendered yet
};

}  // namespace concord::hmd
