#include "semantic/segmentation/segment.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>

#include "semantic/segmentation/flat_top.hpp"
#include "semantic/segmentation/room_planes.hpp"
#include "semantic/segmentation/upright_face.hpp"

namespace concord {
namespace {

VoxelIndex operator+(VoxelIndex v, VoxelIndex d) { return {v.x + d.x, v.y + d.y, v.z + d.z}; }

int voxels_in(double metres, double resolution) { return static_cast<int>(std::lround(metres / resolution)); }

BrickMasks within(const BrickMasks& occupied, VoxelIndex seed, int reach) {
  BrickMasks out;
  for (const auto& [index, mask] : occupied.sorted()) {
    const VoxelIndex low = origin_of(index);
    const auto near = [&](std::int32_t c, std::int32_t s) { return c + 7 >= s - reach && c <= s + reach; };
    if (near(low.x, seed.x) && near(low.y, seed.y) && near(low.z, seed.z)) out.insert(index, mask);
  }
  return out;
}

/// The voxel nearest to the seed, of equals the first.
std::optional<VoxelIndex> nearest(const BrickMasks& voxels, const Eigen::Vector3d& p, double resolution) {
  std::optional<VoxelIndex> best;
  double least = kFarthestTouch * kFarthestTouch;
  for (const VoxelIndex v : voxels.voxels()) {
    const double distance = (centre_of(v, resolution) - p).squaredNorm();
    if (distance < least) least = distance, best = v;
  }
  return best;
}

/// All below a level top; of a seat with what rises behind it.
BrickMasks below(const FlatTop& top, const BrickMasks& occupied, std::int32_t floor_z, double resolution) {
  BrickMasks out;
  const int rest = voxels_in(kRestHeight, resolution);
  const auto take = [&](Cell cell, std::int32_t highest) {
    for (std::int32_t z = floor_z; z <= highest; ++z) {
      if (const VoxelIndex v{cell.first, cell.second, z}; occupied.contains(v)) out.insert(v);
    }
  };
  for (const auto& [cell, z] : top.cells) take(cell, z);
  for (const Cell& cell : top.behind) take(cell, top.z + rest);
  return out;
}

/// The layer of what the seed stands on: the highest level top under it or beside it.
std::optional<std::int32_t> support_below(const BrickMasks& occupied, std::int32_t floor_z, VoxelIndex seed,
                                          double resolution) {
  const int side = voxels_in(0.3, resolution);
  std::optional<std::int32_t> best;
  for (const auto& [dx, dy] : {std::pair{0, 0}, {-side, 0}, {side, 0}, {0, -side}, {0, side}}) {
    for (std::int32_t z = seed.z - 1; z > floor_z + 1 && z > seed.z - voxels_in(1.2, resolution); --z) {
      const VoxelIndex v{seed.x + dx, seed.y + dy, z};
      if (!occupied.contains(v) || occupied.contains(v + VoxelIndex{0, 0, 1})) continue;
      const auto top = find_flat_top(occupied, floor_z, v, resolution);
      if (top && top->z < seed.z - 1 && (!best || top->z > *best)) best = top->z;
      break;
    }
  }
  return best;
}

BrickMasks above(const BrickMasks& occupied, std::int32_t z) {
  BrickMasks out;
  for (const VoxelIndex v : occupied.voxels()) {
    if (v.z > z) out.insert(v);
  }
  return out;
}

BrickMasks cluster(const BrickMasks& candidates, VoxelIndex seed, int reach) {
  BrickMasks out;
  std::set<VoxelIndex> seen{seed};
  std::deque<VoxelIndex> open{seed};
  while (!open.empty()) {
    const VoxelIndex at = open.front();
    open.pop_front();
    out.insert(at);
    for (int i = 0; i < 27; ++i) {
      const VoxelIndex next = at + VoxelIndex{i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
      const bool near = std::abs(next.x - seed.x) <= reach && std::abs(next.y - seed.y) <= reach &&
                        std::abs(next.z - seed.z) <= reach;
      if (near && candidates.contains(next) && seen.insert(next).second) open.push_back(next);
    }
  }
  return out;
}

}  // namespace

VoxelBox reach_of_touch(const Eigen::Vector3d& p_map, double resolution) {
  const double farthest = (kMaxVoxel - 1) * resolution;
  const Eigen::Vector3d p = p_map.cwiseMax(-farthest).cwiseMin(farthest);
  const VoxelIndex seed = voxel_of(p, resolution);
  const int reach = voxels_in(kSegmentReach, resolution);
  return {{seed.x - reach, seed.y - reach, seed.z - reach}, {seed.x + reach, seed.y + reach, seed.z + reach}};
}

Result<Proposal> propose_object(const BrickMasks& occupied, double resolution, const Eigen::Vector3d& p_map) {
  if (!p_map.allFinite() || p_map.cwiseAbs().maxCoeff() > (kMaxVoxel - 1) * resolution) {
    return refuse(Code::kOutOfBounds, "the seed lies beyond any map");
  }
  const VoxelIndex touched = voxel_of(p_map, resolution);
  BrickMasks free_of_room = within(occupied, touched, voxels_in(kSegmentReach, resolution));
  const RoomPlanes room = find_room_planes(free_of_room, resolution);
  free_of_room.erase(room.voxels);
  const auto seed = nearest(free_of_room, p_map, resolution);
  if (!seed)
    return refuse(Code::kEmpty, "there is no object within 0.5 m of the seed; floor, walls and ceiling are none");
  const std::int32_t floor_z = room.floor_z.value_or(seed->z - voxels_in(1.5, resolution));

  if (auto top = find_flat_top(free_of_room, floor_z, *seed, resolution)) {
    reach_walls(*top, room.voxels, resolution);
    return Proposal{below(*top, free_of_room, floor_z, resolution), Proposal::Kind::kFlatTopped};
  }
  const auto support = support_below(free_of_room, floor_z, *seed, resolution);
  const BrickMasks candidates = above(free_of_room, support ? *support + 1 : floor_z);
  if (auto face = find_upright_face(candidates, *seed, resolution)) {
    return Proposal{std::move(*face), Proposal::Kind::kUpright};
  }
  return Proposal{cluster(candidates, *seed, voxels_in(kClusterReach, resolution)), Proposal::Kind::kCluster};
}

}  // namespace concord
