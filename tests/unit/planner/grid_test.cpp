#include "planner/grid.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "sketch.hpp"

namespace concord {
namespace {

/// The rule, voxel by voxel.
LogOdds expected(const BrickMap& map, Cell cell, double resolution, double zmin, double zmax, double free_share) {
  int height = 0;
  int free = 0;
  for (std::int32_t z = -40; z < 40; ++z) {
    const double centre = (z + 0.5) * resolution;
    if (centre < zmin || centre >= zmax) continue;
    ++height;
    const LogOdds l = map.at({cell.x, cell.y, z});
    if (is_known(l) && is_occupied(l)) return kOccupied;
    free += is_free(l) ? 1 : 0;
  }
  return free > 0 && free >= free_share * height - 1e-9 ? kFree : kUnknown;
}

/// A brick of one of the kinds that are kept differently: dense, sparse, of one value, empty.
Brick random_brick(std::mt19937& random) {
  const int kind = static_cast<int>(random() % 6);
  if (kind == 0) return {};
  VoxelMask all;
  all.fill(~std::uint64_t{0});
  if (kind == 1) return Brick::uniform(all, kFree);
  const double known = kind == 2 ? 0.15 : 0.9;
  const double occupied = kind == 3 ? 0.0 : 0.02;
  DenseBrick dense;
  std::uniform_real_distribution<double> share(0, 1);
  for (LogOdds& l : dense) {
    if (share(random) >= known) {
      l = kUnknown;
    } else {
      l = static_cast<LogOdds>(share(random) < occupied ? random() % 4000 : -1 - static_cast<int>(random() % 4000));
    }
  }
  return Brick::from_dense(dense);
}

std::vector<BrickIndex> change_some(std::mt19937& random, BrickMap& map, int count) {
  std::vector<BrickIndex> touched;
  for (int i = 0; i < count; ++i) {
    const BrickIndex index{static_cast<std::int32_t>(random() % 6) - 3, static_cast<std::int32_t>(random() % 6) - 3,
                           static_cast<std::int32_t>(random() % 10) - 5};
    if (map.set(index, random_brick(random))) touched.push_back(index);
  }
  return touched;
}

TEST(Band, HoldsTheVoxelsWhoseCentreLiesInIt) {
  const auto span = [](double zmin, double zmax, double r) {
    const Band band = make_band(zmin, zmax, r).value();
    return std::pair(band.first, band.last);
  };
  EXPECT_EQ(span(0, 1, 1.0), std::pair(0, 1));
  EXPECT_EQ(span(0.1, 1.8, 0.05), std::pair(2, 36));
  EXPECT_EQ(span(-0.25, 0.25, 0.5), std::pair(-1, 0));  // centres -0.25 (in) and 0.25 (out)
  EXPECT_EQ(span(0.5, 1.5, 1.0), std::pair(0, 1));
  EXPECT_EQ(span(0.51, 1.51, 1.0), std::pair(1, 2));
}

TEST(Band, RefusesWhatIsNoBand) {
  EXPECT_EQ(make_band(0, std::nan(""), 0.05).error().code, Code::kNotFinite);
  EXPECT_EQ(make_band(-INFINITY, 1, 0.05).error().code, Code::kNotFinite);
  EXPECT_EQ(make_band(1, 1, 0.05).error().code, Code::kEmpty);
  EXPECT_EQ(make_band(2, 1, 0.05).error().code, Code::kEmpty);
  EXPECT_EQ(make_band(0.03, 0.07, 0.05).error().code, Code::kEmpty);  // between two centres
  EXPECT_EQ(make_band(0, 1e12, 0.05).error().code, Code::kOutOfBounds);
}

TEST(Grid, OneOccupiedVoxelOutweighsAllFreeOnes) {
  BrickMap map;
  DenseBrick dense;
  dense.fill(kFree);
  dense[local_of(VoxelIndex{3, 4, 5})] = 0;  // as likely as not counts as occupied
  map.set({0, 0, 0}, Brick::from_dense(dense));
  Grid grid(0.1, make_band(0, 0.8, 0.1).value(), 0.5);
  grid.update(map, map.sorted_bricks());
  EXPECT_EQ(grid.at({3, 4}), kOccupied);
  EXPECT_EQ(grid.at({4, 4}), kFree);
  EXPECT_EQ(grid.at({8, 4}), kUnknown);
}

TEST(Grid, FreeNeedsItsShareOfTheWholeBand) {
  BrickMap map;
  DenseBrick dense;
  dense.fill(kUnknown);
  for (int z = 0; z < 4; ++z) dense[local_of(VoxelIndex{0, 0, z})] = kFree;
  for (int z = 0; z < 3; ++z) dense[local_of(VoxelIndex{1, 0, z})] = kFree;
  map.set({0, 0, 0}, Brick::from_dense(dense));
  Grid half(0.1, make_band(0, 0.8, 0.1).value(), 0.5);
  half.update(map, map.sorted_bricks());
  EXPECT_EQ(half.at({0, 0}), kFree);
  EXPECT_EQ(half.at({1, 0}), kUnknown);
  Grid third(0.1, make_band(0, 0.8, 0.1).value(), 0.375);
  third.update(map, map.sorted_bricks());
  EXPECT_EQ(third.at({1, 0}), kFree);
  Grid higher(0.1, make_band(0, 0.9, 0.1).value(), 0.5);  // four of nine are not half
  higher.update(map, map.sorted_bricks());
  EXPECT_EQ(higher.at({0, 0}), kUnknown);
}

TEST(Grid, EqualsTheRuleVoxelByVoxel) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    BrickMap map;
    change_some(random, map, 200);
    const double zmin = -2.0 + 0.01 * static_cast<double>(random() % 200);
    const double zmax = zmin + 0.06 + 0.01 * static_cast<double>(random() % 180);
    const double free_share = 0.05 * (1 + static_cast<double>(random() % 20));
    Grid grid(0.05, make_band(zmin, zmax, 0.05).value(), free_share);
    grid.update(map, map.sorted_bricks());
    for (std::int32_t y = -25; y < 25; ++y) {
      for (std::int32_t x = -25; x < 25; ++x) {
        ASSERT_EQ(grid.at({x, y}), expected(map, {x, y}, 0.05, zmin, zmax, free_share))
            << "seed " << seed << " cell " << x << " " << y << " band " << zmin << " " << zmax;
      }
    }
  }
}

TEST(Grid, ChangesAloneLeadToTheSameGridAndAreReportedExactly) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    const Band band = make_band(-0.73, 1.31, 0.05).value();
    BrickMap map;
    Grid grid(0.05, band, 0.4);
    for (int round = 0; round < 20; ++round) {
      const BrickMap before = grid.cells();
      const std::vector<ColumnChange> changes = grid.update(map, change_some(random, map, 15));
      Grid scratch(0.05, band, 0.4);
      scratch.update(map, map.sorted_bricks());
      ASSERT_TRUE(grid.cells() == scratch.cells()) << "seed " << seed << " round " << round;

      std::set<BrickIndex> reported;
      for (const ColumnChange& change : changes) {
        reported.insert(change.column);
        const std::uint64_t was = free_plane(before.find(change.column));
        const std::uint64_t is = free_plane(grid.cells().find(change.column));
        EXPECT_EQ(change.freed, is & ~was);
        EXPECT_EQ(change.blocked, was & ~is);
      }
      EXPECT_EQ(reported.size(), changes.size());
      for (std::int32_t y = -3; y < 3; ++y) {
        for (std::int32_t x = -3; x < 3; ++x) {
          const Brick* was = before.find(BrickIndex{x, y, 0});
          const Brick* is = grid.cells().find(BrickIndex{x, y, 0});
          EXPECT_EQ(reported.contains({x, y, 0}), (was ? *was : Brick()) != (is ? *is : Brick()));
        }
      }
    }
  }
}

TEST(Grid, AVanishedMapLeavesNothing) {
  std::mt19937 random(7);
  BrickMap map;
  change_some(random, map, 200);
  Grid grid(0.05, make_band(0, 1, 0.05).value(), 0.5);
  const std::vector<BrickIndex> all = map.sorted_bricks();
  grid.update(map, all);
  ASSERT_FALSE(grid.cells().empty());
  map.clear();
  grid.update(map, all);
  EXPECT_TRUE(grid.cells().empty());
}

}  // namespace
}  // namespace concord
