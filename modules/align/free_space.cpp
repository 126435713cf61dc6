#include "align/free_space.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "align/workers.hpp"

namespace concord {
namespace {

/// A block of 2 x 2 x 2 voxels is free when none of it is occupied and this many are known to be free: one voxel alone
/// may be the rim of a single ray.
constexpr int kMinFreeVoxels = 2;

constexpr double kMaxChord = 10.0;  // metres between two surfaces that face each other
constexpr double kFacing = 0.7;     // cosine between a chord and the normal where it ends
constexpr double kHit = 0.87;       // cells from a mean: half the diagonal of a cell
constexpr double kGap = 2.0;        // cells that are left open at either end
constexpr std::size_t kMaxChords = 60'000;
constexpr std::size_t kChordsPerChunk = 256;
constexpr double kFloorNormalZ = 0.95;
constexpr double kPerson = 1.8;  // metres over a floor that whoever saw it saw as well

/// Blocks without an occupied voxel and with enough free ones.
std::uint64_t free_blocks(const Brick& brick) {
  const VoxelMask known = brick.known();
  const VoxelMask occupied = brick.occupied();
  std::uint64_t out = 0;
  for (int block = 0; block < 64; ++block) {
    const int shift = (block & 3) * 2 + (block >> 2 & 3) * 16;
    const int layer = (block >> 4) * 2;
    const std::uint64_t pattern = std::uint64_t{0x0303} << shift;
    if (((occupied[layer] | occupied[layer + 1]) & pattern) != 0) continue;
    const int count = std::popcount(known[layer] & pattern) + std::popcount(known[layer + 1] & pattern);
    if (count >= kMinFreeVoxels) out |= std::uint64_t{1} << block;
  }
  return out;
}

/// Blocks from a piece of surface along `direction` to the surface that it faces; none where it faces none.
void walk(const SurfaceLevel& surface, const SurfaceCell& from, const Eigen::Vector3d& direction, double floor_limit,
          std::vector<VoxelIndex>& out) {
  const double size = surface.size();
  const int steps = static_cast<int>(kMaxChord / size);
  const Eigen::Vector3d start = from.mean.cast<double>();
  int end = -1;
  for (int i = 2; i <= steps && end < 0; ++i) {
    const Eigen::Vector3d p = start + i * size * direction;
    const SurfaceCell* hit = surface.nearest(p);
    if (hit == nullptr || (hit->mean.cast<double>() - p).norm() > kHit * size) continue;
    if (hit->is_flat() && std::abs(hit->normal.cast<double>().dot(direction)) < kFacing) return;
    end = i;
  }
  if (end < 0) end = static_cast<int>(floor_limit / size);  // 0 unless it stands on a floor
  for (int i = static_cast<int>(kGap); i <= end - static_cast<int>(kGap); ++i) {
    out.push_back(voxel_of(start + i * size * direction, size));
  }
}

/// Level ground in the lower half of what is level: a ceiling is level as well, and nobody saw what is over it.
double highest_floor(const SurfaceLevel& surface) {
  std::vector<float> heights;
  for (const SurfaceCell& cell : surface.cells()) {
    if (std::abs(cell.normal.z()) > kFloorNormalZ) heights.push_back(cell.mean.z());
  }
  if (heights.empty()) return -INFINITY;
  std::sort(heights.begin(), heights.end());
  const std::size_t rim = heights.size() / 50;
  const double low = heights[rim];
  const double high = heights[heights.size() - 1 - rim];
  return high - low < 1.0 ? high + 1.0 : 0.5 * (low + high);
}

}  // namespace

FreeSpace FreeSpace::known(const BrickMap& map, double resolution) {
  FreeSpace out;
  out.block_ = 2.0 * resolution;
  for (const BrickIndex index : map.sorted_bricks()) {
    const std::uint64_t blocks = free_blocks(*map.find(index));
    if (blocks == 0) continue;
    out.bricks_.insert({index.x, index.y, index.z});
    out.blocks_.push_back(blocks);
  }
  return out;
}

FreeSpace FreeSpace::implied(const SurfaceLevel& surface, int threads) {
  FreeSpace out;
  out.block_ = surface.size();
  const std::vector<SurfaceCell>& cells = surface.cells();
  const std::size_t stride = 1 + cells.size() / kMaxChords;
  const std::size_t count = chunks_of(cells.size(), stride);
  const double highest = highest_floor(surface);
  std::vector<std::vector<VoxelIndex>> parts(chunks_of(count, kChordsPerChunk));
  for_each_chunk(threads, parts.size(), [&](std::size_t chunk) {
    for (std::size_t i = chunk * kChordsPerChunk; i < std::min(count, (chunk + 1) * kChordsPerChunk); ++i) {
      const SurfaceCell& cell = cells[i * stride];
      if (!cell.is_flat()) continue;
      const Eigen::Vector3d n = cell.normal.cast<double>();
      const bool is_floor = std::abs(n.z()) > kFloorNormalZ && cell.mean.z() < highest;
      walk(surface, cell, n, is_floor && n.z() > 0.0 ? kPerson : 0.0, parts[chunk]);
      walk(surface, cell, -n, is_floor && n.z() < 0.0 ? kPerson : 0.0, parts[chunk]);
    }
  });
  for (const std::vector<VoxelIndex>& part : parts) {
    for (const VoxelIndex& b : part) {
      const auto brick = static_cast<std::size_t>(out.bricks_.insert({b.x >> 2, b.y >> 2, b.z >> 2}));
      if (brick == out.blocks_.size()) out.blocks_.push_back(0);
      out.blocks_[brick] |= std::uint64_t{1} << ((b.x & 3) | (b.y & 3) << 2 | (b.z & 3) << 4);
    }
  }
  return out;
}

bool FreeSpace::contains(const Eigen::Vector3d& p) const {
  if (blocks_.empty()) return false;
  const VoxelIndex b = voxel_of(p, block_);
  const int brick = bricks_.find({b.x >> 2, b.y >> 2, b.z >> 2});
  return brick >= 0 && (blocks_[brick] >> ((b.x & 3) | (b.y & 3) << 2 | (b.z & 3) << 4) & 1) != 0;
}

std::size_t FreeSpace::block_count() const {
  std::size_t count = 0;
  for (const std::uint64_t blocks : blocks_) count += std::popcount(blocks);
  return count;
}

std::vector<FreeColumn> FreeSpace::columns() const {
  std::vector<FreeColumn> out;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const VoxelIndex at = bricks_.cells()[i];
    for (int column = 0; column < 16; ++column) {
      const int count = std::popcount(blocks_[i] >> column & 0x0001000100010001ULL);
      if (count == 0) continue;
      const Eigen::Vector3d p((at.x * 4 + (column & 3) + 0.5) * block_, (at.y * 4 + (column >> 2) + 0.5) * block_,
                              (at.z * 4 + 2.0) * block_);
      out.push_back({p.cast<float>(), static_cast<float>(count * block_), static_cast<float>(block_ * block_)});
    }
  }
  return out;
}

}  // namespace concord
