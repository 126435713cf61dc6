#include "align/free_space.hpp"

#include <algorithm>
#include <array>
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
constexpr int kGap = 2;             // cells that are left open at either end
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

/// Every cell of a surface and those around it: outside of these `nearest` finds nothing.
BlockSet surroundings(const SurfaceLevel& surface) {
  BlockSet out;
  StopLook stop;
  for (const SurfaceCell& cell : surface.cells()) {
    stop.step();
    const VoxelIndex at = cell_of(cell.mean.cast<double>(), 1.0 / surface.size());
    for (int step = 0; step < 27; ++step)
      out.insert({at.x + step % 3 - 1, at.y + step / 3 % 3 - 1, at.z + step / 9 - 1});
  }
  return out;
}

/// Walks from pieces of surface to what they face.
class Walker {
 public:
  explicit Walker(const SurfaceLevel& surface) : surface_(surface), near_(surroundings(surface)) {}

  /// Adds the blocks from a piece along `direction` to the surface that it faces; up to `limit` metres where it faces
  /// none.
  void walk(const SurfaceCell& from, const Eigen::Vector3d& direction, double limit,
            std::vector<VoxelIndex>& out) const {
    const double size = surface_.size();
    const int steps = static_cast<int>(kMaxChord / size);
    const Eigen::Vector3d start = from.mean.cast<double>();
    std::array<VoxelIndex, kMaxSteps> passed;
    int end = -1;
    for (int i = kGap; i <= steps && end < 0; ++i) {
      const Eigen::Vector3d p = start + i * size * direction;
      passed[i] = cell_of(p, 1.0 / size);
      if (!near_.contains(passed[i])) continue;
      const SurfaceCell* hit = surface_.nearest(p);
      if (hit == nullptr || (hit->mean.cast<double>() - p).norm() > kHit * size) continue;
      if (hit->is_flat() && std::abs(hit->normal.cast<double>().dot(direction)) < kFacing) return;
      end = i;
    }
    if (end < 0) end = static_cast<int>(limit / size);
    out.insert(out.end(), passed.begin() + kGap, passed.begin() + std::max(kGap, end - kGap + 1));
  }

 private:
  static constexpr int kMaxSteps = 128;
  const SurfaceLevel& surface_;
  BlockSet near_;
};

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

ObservedFreeSpace ObservedFreeSpace::known(const BrickMap& map, double resolution) {
  ObservedFreeSpace out;
  out.block_ = 2.0 * resolution;
  out.per_metre_ = 1.0 / out.block_;
  StopLook stop;
  for (const BrickIndex index : map.sorted_bricks()) {
    stop.step();
    const std::uint64_t blocks = free_blocks(*map.find(index));
    if (blocks == 0) continue;
    out.blocks_.insert_brick({index.x, index.y, index.z}, blocks);
  }
  return out;
}

ObservedFreeSpace ObservedFreeSpace::implied(const SurfaceLevel& surface, int threads) {
  ObservedFreeSpace out;
  out.block_ = surface.size();
  out.per_metre_ = 1.0 / out.block_;
  const Walker walker(surface);
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
      walker.walk(cell, n, is_floor && n.z() > 0.0 ? kPerson : 0.0, parts[chunk]);
      walker.walk(cell, -n, is_floor && n.z() < 0.0 ? kPerson : 0.0, parts[chunk]);
    }
  });
  for (const std::vector<VoxelIndex>& part : parts) {
    look_for_stop();
    for (const VoxelIndex& b : part) out.blocks_.insert(b);
  }
  return out;
}

ObservedFreeSpace ObservedFreeSpace::mirrored() const {
  ObservedFreeSpace out;
  out.block_ = block_;
  out.per_metre_ = per_metre_;
  StopLook stop;
  for (std::size_t i = 0; i < blocks_.words().size(); ++i) {
    stop.step();
    const std::uint64_t word = blocks_.words()[i];
    const std::uint64_t pairs = (word & 0x5555555555555555ULL) << 1 | (word >> 1 & 0x5555555555555555ULL);
    const std::uint64_t cells = (pairs & 0x3333333333333333ULL) << 2 | (pairs >> 2 & 0x3333333333333333ULL);
    const VoxelIndex at = blocks_.bricks()[i];
    out.blocks_.insert_brick({-1 - at.x, at.y, at.z}, cells);
  }
  return out;
}

bool ObservedFreeSpace::contains(const Eigen::Vector3d& p) const { return blocks_.contains(cell_of(p, per_metre_)); }

std::size_t ObservedFreeSpace::block_count() const {
  std::size_t count = 0;
  for (const std::uint64_t blocks : blocks_.words()) count += std::popcount(blocks);
  return count;
}

std::vector<FreeColumn> ObservedFreeSpace::columns() const {
  std::vector<FreeColumn> out;
  StopLook stop;
  for (std::size_t i = 0; i < blocks_.words().size(); ++i) {
    stop.step();
    const VoxelIndex at = blocks_.bricks()[i];
    for (int column = 0; column < 16; ++column) {
      const int count = std::popcount(blocks_.words()[i] >> column & 0x0001000100010001ULL);
      if (count == 0) continue;
      const Eigen::Vector3d p((at.x * 4 + (column & 3) + 0.5) * block_, (at.y * 4 + (column >> 2) + 0.5) * block_,
                              (at.z * 4 + 2.0) * block_);
      out.push_back({p.cast<float>(), static_cast<float>(count * block_), static_cast<float>(block_ * block_)});
    }
  }
  return out;
}

}  // namespace concord
