#include "merge/conflict_report.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/tile_puller.hpp"

namespace concord {
namespace {

struct Ranked {
  TileIndex tile;
  int voxels;
};

/// All tiles with conflicts, those with the most first; equal ones in the order of their tiles.
std::vector<Ranked> ranked_tiles(const BrickMap& conflicts) {
  std::vector<Ranked> ranked;
  for (const TileIndex index : conflicts.sorted_tiles()) {
    int voxels = 0;
    for (const Brick& brick : conflicts.find(index)->bricks) voxels += brick.known_count();
    ranked.push_back({index, voxels});
  }
  std::ranges::stable_sort(ranked, std::ranges::greater{}, &Ranked::voxels);
  return ranked;
}

/// Calls `visit(BrickIndex, local voxel)` for each conflicting voxel of a tile.
template <class Visit>
void for_each_voxel(TileIndex index, const Tile& tile, Visit&& visit) {
  const Brick* brick = tile.bricks.data();
  for (std::uint64_t bits = tile.present; bits != 0; bits &= bits - 1, ++brick) {
    const BrickIndex at = brick_at(index, std::countr_zero(bits));
    brick->for_each([&](int local, LogOdds) { visit(at, local); });
  }
}

ConflictRegion region_of(TileIndex index, const Tile& tile, int voxels) {
  ConflictRegion region{{kMaxVoxel, kMaxVoxel, kMaxVoxel}, {-kMaxVoxel, -kMaxVoxel, -kMaxVoxel}, voxels, {}};
  for_each_voxel(index, tile, [&](BrickIndex brick, int local) {
    const VoxelIndex v = voxel_at(brick, local);
    region.min = {std::min(region.min.x, v.x), std::min(region.min.y, v.y), std::min(region.min.z, v.z)};
    region.max = {std::max(region.max.x, v.x), std::max(region.max.y, v.y), std::max(region.max.z, v.z)};
  });
  return region;
}

LogOdds value_in(const LayerTile& pulled, BrickIndex brick, int local) {
  const int position = local_of(brick);
  if ((pulled.bricks >> position & 1) == 0) return kUnknown;
  return pulled.is_whole ? pulled.whole[position]->at(local) : log_odds_of(pulled.keys[position][local]);
}

}  // namespace

ConflictReport report_conflicts(const LayeredMap& map, std::size_t most) {
  ConflictReport report;
  std::vector<Ranked> ranked = ranked_tiles(map.conflicts());
  report.regions_in_all = static_cast<std::int64_t>(ranked.size());
  for (const Ranked& tile : ranked) report.voxels_in_all += tile.voxels;
  ranked.resize(std::min(ranked.size(), most));
  for (const Ranked& at : ranked) {
    report.regions.push_back(region_of(at.tile, *map.conflicts().find(at.tile), at.voxels));
  }
  TilePuller puller;
  LayerTile pulled;
  for (const auto& [agent, layer] : map.layers()) {
    if (!layer.lattice) continue;
    for (std::size_t i = 0; i < ranked.size(); ++i) {
      const Tile& tile = *map.conflicts().find(ranked[i].tile);
      puller.pull(layer.map, *layer.lattice, ranked[i].tile, tile.present, pulled);
      if (pulled.bricks == 0) continue;
      ConflictRegion::Claim claim{agent, 0, 0};
      for_each_voxel(ranked[i].tile, tile, [&](BrickIndex brick, int local) {
        const LogOdds value = value_in(pulled, brick, local);
        claim.occupied += is_occupied(value) ? 1 : 0;
        claim.free += is_free(value) ? 1 : 0;
      });
      if (claim.occupied + claim.free > 0) report.regions[i].claims.push_back(std::move(claim));
    }
  }
  return report;
}

}  // namespace concord
