#include "align/free_space.hpp"

#include <algorithm>
#include <bit>

namespace concord {
namespace {

/// A block of 2 x 2 x 2 voxels is free when none of it is occupied and this many are known to be free: one voxel alone
/// may be the rim of a single ray.
constexpr int kMinFreeVoxels = 2;

constexpr float kFloorNormalZ = 0.9F;
constexpr float kFloorGap = 0.3F;      // metres over a floor that are left open: skirting, thresholds, noise
constexpr float kCeilingGap = 0.2F;    // metres under what hangs over it
constexpr float kPerson = 1.8F;        // metres over a floor that whoever saw it saw as well
constexpr float kMinClearance = 0.4F;  // metres

/// Free voxels that touch no occupied one in their block, by block.
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

}  // namespace

FreeSpace FreeSpace::known(const BrickMap& map, double resolution) {
  FreeSpace out;
  out.cell_ = kBrickSide * resolution;
  for (const BrickIndex index : map.sorted_bricks()) {
    const std::uint64_t blocks = free_blocks(*map.find(index));
    if (blocks == 0) continue;
    out.table_.insert({index.x, index.y, index.z});
    out.blocks_.push_back(blocks);
  }
  return out;
}

FreeSpace FreeSpace::over_floors(const SurfaceLevel& surface) {
  struct Piece {
    float z;
    bool flat;
  };
  FreeSpace out;
  out.cell_ = surface.size();
  CellTable columns;
  std::vector<std::vector<Piece>> pieces;
  std::vector<float> heights;
  for (const SurfaceCell& cell : surface.cells()) {
    VoxelIndex at = voxel_of(cell.mean.cast<double>(), out.cell_);
    at.z = 0;
    const auto column = static_cast<std::size_t>(columns.insert(at));
    if (column == pieces.size()) pieces.emplace_back();
    const bool level = std::abs(cell.normal.z()) > kFloorNormalZ;
    pieces[column].push_back({cell.mean.z(), level});
    if (level) heights.push_back(cell.mean.z());
  }
  if (heights.empty()) return out;
  // A ceiling is level as well, and nobody has seen what is over it: only the lower half of what is level is floor.
  std::sort(heights.begin(), heights.end());
  const float low = heights[heights.size() / 50];
  const float high = heights[heights.size() - 1 - heights.size() / 50];
  const float middle = 0.5F * (low + high);
  const bool one_floor = high - low < 1.0F;
  for (std::size_t column = 0; column < pieces.size(); ++column) {
    std::vector<Piece>& stack = pieces[column];
    std::sort(stack.begin(), stack.end(), [](const Piece& a, const Piece& b) { return a.z < b.z; });
    if (!stack.front().flat || (!one_floor && stack.front().z > middle)) continue;
    const float floor = stack.front().z;
    float ceiling = floor + kPerson;
    for (const Piece& piece : stack) {
      if (piece.z > floor + kFloorGap) ceiling = std::min(ceiling, piece.z - kCeilingGap);
    }
    if (ceiling - floor < kFloorGap + kMinClearance) continue;
    out.table_.insert(columns.cells()[column]);
    out.clearances_.push_back({floor + kFloorGap, ceiling});
  }
  return out;
}

bool FreeSpace::contains(const Eigen::Vector3d& p) const {
  if (table_.cells().empty()) return false;
  if (blocks_.empty()) {
    VoxelIndex at = voxel_of(p, cell_);
    at.z = 0;
    const int column = table_.find(at);
    return column >= 0 && p.z() > clearances_[column].low && p.z() < clearances_[column].high;
  }
  const VoxelIndex block = voxel_of(p, 0.25 * cell_);
  const int brick = table_.find({block.x >> 2, block.y >> 2, block.z >> 2});
  return brick >= 0 && (blocks_[brick] >> ((block.x & 3) | (block.y & 3) << 2 | (block.z & 3) << 4) & 1) != 0;
}

std::size_t FreeSpace::block_count() const {
  std::size_t count = 0;
  for (const std::uint64_t blocks : blocks_) count += std::popcount(blocks);
  return count;
}

std::vector<FreeColumn> FreeSpace::columns() const {
  std::vector<FreeColumn> out;
  const std::vector<VoxelIndex>& cells = table_.cells();
  if (blocks_.empty()) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      Eigen::Vector3d p = centre_of(cells[i], cell_);
      p.z() = 0.5 * (clearances_[i].low + clearances_[i].high);
      out.push_back({p.cast<float>(), clearances_[i].high - clearances_[i].low, static_cast<float>(cell_ * cell_)});
    }
    return out;
  }
  const double side = 0.25 * cell_;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (int column = 0; column < 16; ++column) {
      const int count = std::popcount(blocks_[i] >> column & 0x0001000100010001ULL);
      if (count == 0) continue;
      const Eigen::Vector3d p((cells[i].x * 4 + (column & 3) + 0.5) * side,
                              (cells[i].y * 4 + (column >> 2) + 0.5) * side, (cells[i].z + 0.5) * cell_);
      out.push_back({p.cast<float>(), static_cast<float>(count * side), static_cast<float>(side * side)});
    }
  }
  return out;
}

}  // namespace concord
