#include "projection_figures.hpp"

#include <ctime>
#include <random>
#include <set>

#include "papers_merge.hpp"
#include "planner/grid.hpp"

namespace concord {
namespace {

constexpr double kResolution = 0.05;
constexpr int kSide = 256, kHeight = 32;  // voxels

template <class Work>
double time_us(Work work) {
  timespec begin{}, end{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &begin);
  work();
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &end);
  return static_cast<double>(end.tv_sec - begin.tv_sec) * 1e6 + static_cast<double>(end.tv_nsec - begin.tv_nsec) * 1e-3;
}

/// Rooms of 3 m with doors, from x = `first` voxels on; some of what is free has not been seen, so that leaves do not
/// all hang together.
BrickMap offices(int first, int columns) {
  std::mt19937 random(1);
  BrickMap map;
  for (int bx = first / 8; bx < (first + columns) / 8; ++bx) {
    for (int by = 0; by < kSide / 8; ++by) {
      for (int bz = 0; bz < kHeight / 8; ++bz) {
        DenseBrick dense;
        for (int i = 0; i < 512; ++i) {
          const int x = bx * 8 + (i & 7), y = by * 8 + (i >> 3 & 7), z = bz * 8 + (i >> 6);
          const bool is_door = (x % 64 > 28 && x % 64 < 46) || (y % 64 > 28 && y % 64 < 46);
          const bool is_wall = z == 0 || ((x % 64 < 2 || y % 64 < 2) && !is_door);
          dense[static_cast<std::size_t>(i)] = is_wall ? kOccupied : random() % 50 == 0 ? kUnknown : kFree;
        }
        map.set({bx, by, bz}, Brick::from_dense(dense));
      }
    }
  }
  return map;
}

/// As a planner does that keeps an OctoMap: all leaves, each over its whole extent.
std::set<Cell> occupied_by_scan(const octomap::OcTree& tree, const Band& band) {
  std::set<Cell> occupied;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    if (!tree.isNodeOccupied(*leaf)) continue;
    const int size = 1 << (tree.getTreeDepth() - leaf.getDepth());
    const octomap::OcTreeKey low = leaf.getIndexKey();
    constexpr int kOrigin = 32768;
    const int z = low[2] - kOrigin;
    if (z + size <= band.first || z >= band.last) continue;
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) occupied.insert({low[0] - kOrigin + x, low[1] - kOrigin + y});
    }
  }
  return occupied;
}

/// The scan alone, without a place to put what it finds: the least that it can take.
std::size_t scan(const octomap::OcTree& tree, const Band& band) {
  std::size_t found = 0;
  const double low = band.first * kResolution, high = band.last * kResolution;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const double half = leaf.getSize() / 2;
    if (leaf.getZ() + half > low && leaf.getZ() - half < high && tree.isNodeOccupied(*leaf)) ++found;
  }
  return found;
}

}  // namespace

ProjectionFigures projection_figures() {
  ProjectionFigures figures;
  const Band band = make_band(0.1, 1.6, kResolution).value();
  BrickMap map = offices(0, kSide);
  Grid grid(kResolution, band, 0.5);
  figures.whole_us = time_us([&] { figures.map_columns = grid.update(map, map.sorted_bricks()).size(); });
  figures.map_voxels = map.known_count();

  const octomap::OcTree tree = bench::to_octree(map, kResolution);
  std::size_t found = 0;
  for (int i = 0; i < 9; ++i) figures.scan_us.push_back(time_us([&] { found += scan(tree, band); }));
  const std::set<Cell> occupied = occupied_by_scan(tree, band);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const LogOdds state = grid.at({x, y});
      figures.wrong_cells += (is_known(state) && is_occupied(state)) != occupied.contains({x, y}) ? 1 : 0;
    }
  }
  if (found == 0) ++figures.wrong_cells;

  std::mt19937 random(2);
  for (int i = 0; i < 500; ++i) {
    const int x = static_cast<int>(random() % (kSide - 10)), y = static_cast<int>(random() % kSide);
    std::set<BrickIndex> touched;
    for (int dx = 0; dx < 10; ++dx) {
      for (int z = 4; z < 24; ++z) touched.insert(brick_of(VoxelIndex{x + dx, y, z}));
    }
    for (const BrickIndex brick : touched) {
      DenseBrick dense;
      map.find(brick)->to_dense(dense);
      for (int dx = 0; dx < 10; ++dx) {
        for (int z = 4; z < 24; ++z) {
          const VoxelIndex voxel{x + dx, y, z};
          if (brick_of(voxel) == brick) dense[local_of(voxel)] = i % 2 == 0 ? kOccupied : kFree;
        }
      }
      map.set(brick, Brick::from_dense(dense));
    }
    const std::vector<BrickIndex> bricks(touched.begin(), touched.end());
    figures.edit_us.push_back(time_us([&] { (void)grid.update(map, bricks); }));
    std::set<std::pair<int, int>> columns;
    for (const BrickIndex brick : bricks) columns.emplace(brick.x, brick.y);
    figures.edit_columns = columns.size();
  }

  const BrickMap submap = offices(kSide, 64);
  const std::vector<BrickIndex> bricks = submap.sorted_bricks();
  submap.for_each_brick([&](BrickIndex index, const Brick& brick) { map.set(index, brick); });
  figures.agent_us = time_us([&] { figures.agent_columns = grid.update(map, bricks).size(); });
  return figures;
}

}  // namespace concord
