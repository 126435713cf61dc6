#include "align/surface.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>

#include "align/cell_table.hpp"
#include "align/workers.hpp"
#include "core/decimal.hpp"

namespace concord {
namespace {

constexpr std::uint64_t kFirstColumn = 0x0101010101010101ULL;  // x = 0 in a layer of 8 x 8
constexpr std::uint64_t kLastColumn = 0x8080808080808080ULL;   // x = 7

/// The occupied voxels of the six bricks around one.
struct Around {
  VoxelMask low_x, high_x, low_y, high_y, low_z, high_z;
};

/// Voxels all six of whose neighbours are occupied. Word z of a mask is a layer, bit x + 8 y.
VoxelMask enclosed(const VoxelMask& m, const Around& around) {
  VoxelMask out{};
  for (int z = 0; z < 8; ++z) {
    const std::uint64_t left = ((m[z] & ~kLastColumn) << 1) | ((around.low_x[z] & kLastColumn) >> 7);
    const std::uint64_t right = ((m[z] & ~kFirstColumn) >> 1) | ((around.high_x[z] & kFirstColumn) << 7);
    const std::uint64_t front = (m[z] << 8) | (around.low_y[z] >> 56);
    const std::uint64_t back = (m[z] >> 8) | (around.high_y[z] << 56);
    const std::uint64_t below = z > 0 ? m[z - 1] : around.low_z[7];
    const std::uint64_t above = z < 7 ? m[z + 1] : around.high_z[0];
    out[z] = left & right & front & back & below & above;
  }
  return out;
}

VoxelMask occupied_at(const BrickMap& map, BrickIndex index) {
  const Brick* brick = map.find(index);
  return brick != nullptr ? brick->occupied() : VoxelMask{};
}

tl::unexpected<Error> refuse_reach() {
  return refuse(Code::kOutOfBounds, "a point is over 10 km from the origin; is the map in metres?");
}

constexpr std::size_t kPointsPerChunk = 4096;
constexpr int kDense = 7;  // of the 27 voxels around a point of a wall 9 are taken
constexpr int kLoner = 5;

}  // namespace

bool are_scattered(std::span<const Eigen::Vector3f> points, double resolution) {
  if (points.size() <= kMaxSurfaceBlocks) return false;
  const double per_metre = 1.0 / (4.0 * resolution);
  constexpr std::int64_t kHalf = 1 << 20;  // 10 km in blocks of 4 cm are a quarter of that
  std::vector<std::uint64_t> blocks;
  blocks.reserve(points.size());
  StopLook stop;
  for (const Eigen::Vector3f& p : points) {
    stop.step();
    const VoxelIndex at = cell_of(p.cast<double>(), per_metre);
    blocks.push_back(static_cast<std::uint64_t>(at.x + kHalf) << 42 | static_cast<std::uint64_t>(at.y + kHalf) << 21 |
                     static_cast<std::uint64_t>(at.z + kHalf));
  }
  std::sort(blocks.begin(), blocks.end());
  return std::unique(blocks.begin(), blocks.end()) - blocks.begin() > static_cast<std::ptrdiff_t>(kMaxSurfaceBlocks);
}

SurfacePoints without_loners(SurfacePoints points, double resolution, int threads) {
  CellTable voxels;
  StopLook stop;
  for (const Eigen::Vector3f& p : points) {
    stop.step();
    voxels.insert(cell_of(p.cast<double>(), 1.0 / resolution));
  }
  std::vector<std::int8_t> crowd(points.size());
  for_each_chunk(threads, chunks_of(points.size(), kPointsPerChunk), [&](std::size_t chunk) {
    CellTable::Cursor cursor(voxels);
    const std::size_t end = std::min(points.size(), (chunk + 1) * kPointsPerChunk);
    for (std::size_t i = chunk * kPointsPerChunk; i < end; ++i) {
      const VoxelIndex at = cell_of(points[i].cast<double>(), 1.0 / resolution);
      for (int step = 0; step < 27; ++step) {
        crowd[i] += cursor.find({at.x + step % 3 - 1, at.y + step / 3 % 3 - 1, at.z + step / 9 - 1}) >= 0 ? 1 : 0;
      }
    }
  });
  std::array<std::size_t, 28> counts{};
  for (const std::int8_t c : crowd) ++counts[c];
  std::size_t sparse = 0;
  for (int c = 0; c < kDense; ++c) sparse += counts[c];
  if (2 * sparse > points.size()) return points;
  SurfacePoints out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (crowd[i] >= kLoner) out.push_back(points[i]);
  }
  return out;
}

Result<SurfacePoints> surface_points(const BrickMap& map, double resolution) {
  if (!std::isfinite(resolution) || resolution < kMinAlignResolution) {
    return refuse(Code::kBadResolution, "maps are aligned at " + decimal(kMinAlignResolution) +
                                            " m or coarser, this one has " + decimal(resolution));
  }
  SurfacePoints points;
  StopLook stop;
  for (const BrickIndex b : map.sorted_bricks()) {
    stop.step();
    const VoxelMask mask = map.find(b)->occupied();
    if (mask == VoxelMask{}) continue;
    const Around around{occupied_at(map, {b.x - 1, b.y, b.z}), occupied_at(map, {b.x + 1, b.y, b.z}),
                        occupied_at(map, {b.x, b.y - 1, b.z}), occupied_at(map, {b.x, b.y + 1, b.z}),
                        occupied_at(map, {b.x, b.y, b.z - 1}), occupied_at(map, {b.x, b.y, b.z + 1})};
    const VoxelMask inside = enclosed(mask, around);
    for (int word = 0; word < 8; ++word) {
      for (std::uint64_t bits = mask[word] & ~inside[word]; bits != 0; bits &= bits - 1) {
        const Eigen::Vector3d p = centre_of(voxel_at(b, word * 64 + std::countr_zero(bits)), resolution);
        if (p.cwiseAbs().maxCoeff() > kMaxSurfaceReach) return refuse_reach();
        points.push_back(p.cast<float>());
      }
    }
    if (points.size() > kMaxSurfacePoints) {
      return refuse(Code::kTooLarge, "over 4 million surface voxels; align a coarser copy of the map");
    }
  }
  return points;
}

Result<SurfacePoints> surface_points(std::span<const Eigen::Vector3f> cloud) {
  if (cloud.size() > kMaxSurfacePoints) {
    return refuse(Code::kTooLarge, "over 4 million points; downsample the cloud");
  }
  StopLook stop;
  for (const Eigen::Vector3f& p : cloud) {
    stop.step();
    if (!p.allFinite()) return refuse(Code::kNotFinite, "a point is not finite");
    if (p.cwiseAbs().maxCoeff() > kMaxSurfaceReach) return refuse_reach();
  }
  return SurfacePoints(cloud.begin(), cloud.end());
}

}  // namespace concord
