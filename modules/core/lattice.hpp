#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

namespace concord {

/// One cell of a lattice with resolution r: index i covers [i r, (i + 1) r) on each axis.
struct VoxelIndex {
  std::int32_t x = 0, y = 0, z = 0;
  auto operator<=>(const VoxelIndex&) const = default;
};

/// 8 x 8 x 8 voxels: floor(voxel / 8). The unit of storage, of streaming and of change.
struct BrickIndex {
  std::int32_t x = 0, y = 0, z = 0;
  auto operator<=>(const BrickIndex&) const = default;
};

/// 4 x 4 x 4 bricks: floor(brick / 4). The unit of look-up and of folding.
struct TileIndex {
  std::int32_t x = 0, y = 0, z = 0;
  auto operator<=>(const TileIndex&) const = default;
};

inline constexpr int kBrickSide = 8;
inline constexpr int kBrickVoxels = 512;
inline constexpr int kTileSide = 4;  // bricks
inline constexpr int kTileBricks = 64;
inline constexpr int kTileVoxelSide = kTileSide * kBrickSide;

/// Voxel indices beyond this are refused at every border: what OctoMap can address, so that any map can be saved.
inline constexpr std::int32_t kMaxVoxel = 1 << 15;

[[nodiscard]] constexpr bool in_bounds(VoxelIndex v) {
  const auto ok = [](std::int32_t c) { return c >= -kMaxVoxel && c < kMaxVoxel; };
  return ok(v.x) && ok(v.y) && ok(v.z);
}
[[nodiscard]] constexpr bool in_bounds(BrickIndex b) {
  const auto ok = [](std::int32_t c) { return c >= -kMaxVoxel / kBrickSide && c < kMaxVoxel / kBrickSide; };
  return ok(b.x) && ok(b.y) && ok(b.z);
}

[[nodiscard]] constexpr BrickIndex brick_of(VoxelIndex v) { return {v.x >> 3, v.y >> 3, v.z >> 3}; }
[[nodiscard]] constexpr TileIndex tile_of(BrickIndex b) { return {b.x >> 2, b.y >> 2, b.z >> 2}; }
[[nodiscard]] constexpr VoxelIndex origin_of(BrickIndex b) { return {b.x * 8, b.y * 8, b.z * 8}; }
[[nodiscard]] constexpr BrickIndex origin_of(TileIndex t) { return {t.x * 4, t.y * 4, t.z * 4}; }

/// Position of a voxel in its brick, 0 to 511, x fastest.
[[nodiscard]] constexpr int local_of(VoxelIndex v) { return (v.x & 7) | (v.y & 7) << 3 | (v.z & 7) << 6; }
/// Position of a brick in its tile, 0 to 63, x fastest.
[[nodiscard]] constexpr int local_of(BrickIndex b) { return (b.x & 3) | (b.y & 3) << 2 | (b.z & 3) << 4; }

[[nodiscard]] constexpr VoxelIndex voxel_at(BrickIndex b, int local) {
  return {b.x * 8 + (local & 7), b.y * 8 + (local >> 3 & 7), b.z * 8 + (local >> 6)};
}
[[nodiscard]] constexpr BrickIndex brick_at(TileIndex t, int local) {
  return {t.x * 4 + (local & 3), t.y * 4 + (local >> 2 & 3), t.z * 4 + (local >> 4)};
}

/// The voxel that holds a point. @pre |p| / resolution < 2^31.
[[nodiscard]] inline VoxelIndex voxel_of(const Eigen::Vector3d& p, double resolution) {
  const Eigen::Vector3d q = (p / resolution).array().floor();
  return {static_cast<std::int32_t>(q.x()), static_cast<std::int32_t>(q.y()), static_cast<std::int32_t>(q.z())};
}
[[nodiscard]] inline Eigen::Vector3d centre_of(VoxelIndex v, double resolution) {
  return {(v.x + 0.5) * resolution, (v.y + 0.5) * resolution, (v.z + 0.5) * resolution};
}

struct IndexHash {
  template <class Index>
  std::size_t operator()(const Index& i) const {
    std::uint64_t h = static_cast<std::uint32_t>(i.x) * 0x9E3779B97F4A7C15ULL;
    h = (h ^ (h >> 29) ^ static_cast<std::uint32_t>(i.y)) * 0xBF58476D1CE4E5B9ULL;
    h = (h ^ (h >> 32) ^ static_cast<std::uint32_t>(i.z)) * 0x94D049BB133111EBULL;
    return h ^ (h >> 31);
  }
};

}  // namespace concord
