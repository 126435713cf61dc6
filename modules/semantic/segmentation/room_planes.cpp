#include "semantic/segmentation/room_planes.hpp"

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <map>
#include <set>
#include <vector>

namespace concord {
namespace {

using Cell = std::pair<std::int32_t, std::int32_t>;

/// Of all voxels: what may lie below a floor or above a ceiling.
constexpr double kBeyond = 0.02;
constexpr std::int32_t kMostThick = 4;  ///< layers of a floor or ceiling besides its own

struct Layers {
  std::map<std::int32_t, std::int64_t> count;  ///< of voxels, by layer
  std::int64_t all = 0;
};

Layers layers_of(const std::vector<VoxelIndex>& voxels) {
  Layers out;
  for (const VoxelIndex v : voxels) ++out.count[v.z];
  out.all = static_cast<std::int64_t>(voxels.size());
  return out;
}

/// The first layer in this direction that is large with its two neighbours, unless too much lies beyond.
template <class Iterator>
std::optional<std::int32_t> level(const Layers& layers, Iterator begin, Iterator end, double resolution) {
  const double least = kFloorArea / (resolution * resolution);
  const auto at = [&](std::int32_t z) {
    const auto it = layers.count.find(z);
    return it != layers.count.end() ? it->second : std::int64_t{0};
  };
  std::int64_t beyond = 0;
  for (auto it = begin; it != end && static_cast<double>(beyond) <= kBeyond * static_cast<double>(layers.all); ++it) {
    const std::int32_t z = it->first;
    const bool peak = it->second >= at(z - 1) && it->second >= at(z + 1);
    if (peak && static_cast<double>(at(z - 1) + it->second + at(z + 1)) >= least) return z;
    beyond += it->second;
  }
  return std::nullopt;
}

/// Up (or, with -1, down) to which layer a level surface is seen: a noisy scan of a floor is several voxels thick.
std::int32_t face_of(const Layers& layers, std::int32_t level, std::int32_t step) {
  const auto at = [&](std::int32_t z) {
    const auto it = layers.count.find(z);
    return it != layers.count.end() ? it->second : std::int64_t{0};
  };
  std::int32_t face = level;
  while (std::abs(face - level) < kMostThick && 2 * at(face + step) >= at(level)) face += step;
  return face;
}

/// Of the layers of a band, those where this column or one of the eight beside it is occupied, by column.
std::map<Cell, std::set<std::int32_t>> layers_by_column(const std::vector<VoxelIndex>& voxels, std::int32_t low,
                                                        std::int32_t high) {
  std::map<Cell, std::set<std::int32_t>> out;
  for (const VoxelIndex v : voxels) {
    if (v.z < low || v.z > high) continue;
    for (int i = 0; i < 9; ++i) out[{v.x + i % 3 - 1, v.y + i / 3 - 1}].insert(v.z);
  }
  return out;
}

/// Those that hang together with others over at least this many cells, along x or y.
std::set<Cell> long_parts(std::set<Cell> cells, std::int32_t least) {
  std::set<Cell> out;
  while (!cells.empty()) {
    std::vector<Cell> part;
    std::deque<Cell> open{*cells.begin()};
    cells.erase(cells.begin());
    Cell low = open.front(), high = open.front();
    while (!open.empty()) {
      const auto [x, y] = part.emplace_back(open.front());
      open.pop_front();
      low = {std::min(low.first, x), std::min(low.second, y)};
      high = {std::max(high.first, x), std::max(high.second, y)};
      for (int i = 0; i < 9; ++i) {
        const Cell next{x + i % 3 - 1, y + i / 3 - 1};
        if (cells.erase(next) != 0) open.push_back(next);
      }
    }
    if (std::max(high.first - low.first, high.second - low.second) >= least) out.insert(part.begin(), part.end());
  }
  return out;
}

}  // namespace

RoomPlanes find_room_planes(const BrickMasks& occupied, double resolution) {
  RoomPlanes out;
  const std::vector<VoxelIndex> voxels = occupied.voxels();
  if (voxels.empty()) return out;
  const Layers layers = layers_of(voxels);
  out.floor_z = level(layers, layers.count.begin(), layers.count.end(), resolution);
  out.ceiling_z = level(layers, layers.count.rbegin(), layers.count.rend(), resolution);
  if (out.floor_z && out.ceiling_z && *out.ceiling_z - *out.floor_z < kLeastHeight / resolution) out.ceiling_z.reset();
  const std::int32_t floor = out.floor_z.value_or(layers.count.begin()->first);
  const std::int32_t ceiling = out.ceiling_z.value_or(layers.count.rbegin()->first);

  const double height = ceiling - floor;
  const auto low = static_cast<std::int32_t>(floor + kWallLow * height);
  const auto high = static_cast<std::int32_t>(floor + kWallHigh * height);
  std::set<Cell> walls;
  for (const auto& [cell, filled] : layers_by_column(voxels, low, high)) {
    if (static_cast<double>(filled.size()) >= kWallFilled * (high - low + 1)) walls.insert(cell);
  }
  if (!out.ceiling_z) walls = long_parts(std::move(walls), static_cast<std::int32_t>(kLeastWall / resolution));
  const std::int32_t floor_face = face_of(layers, floor, 1), ceiling_face = face_of(layers, ceiling, -1);
  for (const VoxelIndex v : voxels) {
    // A floor leans by a voxel too; what stands above its lowest voxel stands on it.
    const bool leans = v.z == floor_face + 1 && !occupied.contains({v.x, v.y, floor_face});
    const bool of_floor = out.floor_z && (v.z <= floor_face || leans);
    const bool of_ceiling = out.ceiling_z && v.z >= ceiling_face - 1;
    if (of_floor || of_ceiling || walls.contains({v.x, v.y})) out.voxels.insert(v);
  }
  return out;
}

}  // namespace concord
