#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <map>
#include <set>

#include "align/block_set.hpp"
#include "align/gicp.hpp"
#include "align/sampling.hpp"
#include "align/wall_grid.hpp"
#include "align/workers.hpp"
#include "rooms.hpp"

namespace concord::test {
namespace {

BrickMap map_of(const std::map<BrickIndex, DenseBrick>& bricks) {
  BrickMap map;
  for (const auto& [index, dense] : bricks) map.set(index, Brick::from_dense(dense));
  return map;
}

void mark(std::map<BrickIndex, DenseBrick>& bricks, VoxelIndex v, LogOdds value) {
  const auto [it, is_new] = bricks.try_emplace(brick_of(v));
  if (is_new) it->second.fill(kUnknown);
  it->second[local_of(v)] = value;
}

TEST(SurfacePoints, LeaveOutWhatIsEnclosed) {
  std::map<BrickIndex, DenseBrick> bricks;
  for (int x = -5; x < 5; ++x) {
    for (int y = 3; y < 13; ++y) {
      for (int z = -2; z < 8; ++z) mark(bricks, {x, y, z}, kOccupied);
    }
  }
  const SurfacePoints points = surface_points(map_of(bricks), 0.1).value();
  EXPECT_EQ(points.size(), 10U * 10U * 10U - 8U * 8U * 8U);
}

RC_GTEST_PROP(SurfacePoints, AreTheOccupiedVoxelsWithANeighbourThatIsNot, ()) {
  std::map<BrickIndex, DenseBrick> bricks;
  std::set<VoxelIndex> occupied;
  const auto voxels = *rc::gen::container<std::vector<std::tuple<int, int, int, bool>>>(
      400, rc::gen::tuple(rc::gen::inRange(-3, 5), rc::gen::inRange(4, 12), rc::gen::inRange(-4, 4),
                          rc::gen::arbitrary<bool>()));
  for (const auto& [x, y, z, is_free] : voxels) {
    mark(bricks, {x, y, z}, is_free ? kFree : kOccupied);
    if (is_free) {
      occupied.erase({x, y, z});
    } else {
      occupied.insert({x, y, z});
    }
  }
  std::size_t expected = 0;
  for (const VoxelIndex& v : occupied) {
    const bool enclosed = occupied.contains({v.x - 1, v.y, v.z}) && occupied.contains({v.x + 1, v.y, v.z}) &&
                          occupied.contains({v.x, v.y - 1, v.z}) && occupied.contains({v.x, v.y + 1, v.z}) &&
                          occupied.contains({v.x, v.y, v.z - 1}) && occupied.contains({v.x, v.y, v.z + 1});
    expected += !enclosed;
  }
  RC_ASSERT(surface_points(map_of(bricks), 0.1).value().size() == expected);
}

TEST(SurfacePoints, RefuseWhatIsNoCloud) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  for (const Eigen::Vector3f& p :
       {Eigen::Vector3f(nan, 0, 0), Eigen::Vector3f(0, inf, 0), Eigen::Vector3f(0, 0, -inf)}) {
    Points points = room();
    points.push_back(p);
    const Result<AlignMap> map = make_align_map(points, kResolution, 1);
    ASSERT_FALSE(map.has_value());
    EXPECT_EQ(map.error().code, Code::kNotFinite);
  }
  EXPECT_EQ(make_align_map(Points{{20'000.0F, 0.0F, 0.0F}}, 0.05, 1).error().code, Code::kOutOfBounds);
  EXPECT_EQ(make_align_map(Points(kMaxSurfacePoints + 1), 0.05, 1).error().code, Code::kTooLarge);
  for (const double resolution : {0.0, -1.0, 0.001, 50.0, std::nan("")}) {
    EXPECT_EQ(make_align_map(Points{}, resolution, 1).error().code, Code::kBadResolution) << resolution;
    EXPECT_EQ(make_align_map(BrickMap{}, resolution, 1).error().code, Code::kBadResolution) << resolution;
  }
}

TEST(SurfaceLevel, HasNormalsOfWallsThatStandAskew) {
  Points wall;
  const Transform T = transform(1.0, 2.0, 0.0, 0.4);
  for (double u = 0.0; u < 4.0; u += kSpacing) {
    for (double z = 0.0; z < 2.0; z += kSpacing) wall.push_back((T * Eigen::Vector3d(u, 0.0, z)).cast<float>());
  }
  const SurfaceLevel level(wall, 0.1, 1);
  const Eigen::Vector3d n = T.linear() * Eigen::Vector3d::UnitY();
  std::size_t flat = 0;
  for (const SurfaceCell& cell : level.cells()) {
    flat += cell.is_flat();
    if (cell.is_flat()) {
      EXPECT_GT(std::abs(cell.normal.cast<double>().dot(n)), 0.99);
    }
  }
  EXPECT_GT(flat, level.cells().size() * 9 / 10);
}

TEST(SurfaceLevel, LeavesOutWhatStraysAboutAWallAndKeepsTheWall) {
  Points wall;
  for (int u = 0; u < 160; ++u) {
    for (int z = 0; z < 80; ++z) {
      const double waves = 0.004 * ((7 * u + 13 * z) % 5 - 2);  // metres across: up to 8 mm either way
      wall.push_back(Eigen::Vector3d(u * kSpacing, waves, z * kSpacing).cast<float>());
    }
  }
  Points all = wall;
  Points strays;
  for (int i = 0; i < 200; ++i) {
    const double off = i % 2 == 0 ? 0.06 : -0.06;
    strays.push_back(Eigen::Vector3d(0.3 + 0.017 * i, off, 0.3 + 0.007 * i).cast<float>());
    all.push_back(strays.back());
  }
  // What is no plane stays: it may be furniture.
  const Eigen::Vector3f alone(20.0F, 0.0F, 1.0F);
  all.push_back(alone);
  const SurfaceLevel level(all, 0.2, 1);
  ASSERT_GT(level.thickness(), 0.004);
  ASSERT_LT(level.thickness(), 0.03);
  const SurfacePoints kept = level.without_strays(all, 1);
  EXPECT_EQ(kept, level.without_strays(all, 2));
  const auto is_kept = [&](const Eigen::Vector3f& p) { return std::find(kept.begin(), kept.end(), p) != kept.end(); };
  EXPECT_EQ(std::count_if(strays.begin(), strays.end(), is_kept), 0);
  EXPECT_TRUE(is_kept(alone));
  EXPECT_GE(kept.size(), wall.size() * 99 / 100);
}

RC_GTEST_PROP(SurfaceLevel, FindsTheNearestMeanThatLiesWithinHalfACell, ()) {
  const auto coordinate = [] { return (*rc::gen::inRange(-1000, 1001)) * 1e-3; };
  Points points;
  for (int i = 0; i < 60; ++i) points.emplace_back(coordinate(), coordinate(), coordinate());
  const SurfaceLevel level(points, 0.25, 1);
  const Eigen::Vector3d p(coordinate(), coordinate(), coordinate());
  double least = 1e9;
  for (const SurfaceCell& cell : level.cells()) least = std::min(least, (cell.mean.cast<double>() - p).norm());
  const SurfaceCell* nearest = level.nearest(p);
  if (least < 0.125 - 1e-5) {
    RC_ASSERT(nearest != nullptr);
    RC_ASSERT((nearest->mean.cast<double>() - p).norm() < least + 1e-5);
  }
}

TEST(ObservedFreeSpace, OfVoxelsIsWhatTheyKnow) {
  std::map<BrickIndex, DenseBrick> bricks;
  for (int i = 0; i < 16; ++i) {
    for (int j = 0; j < 4; ++j) {
      for (int k = -4; k < 0; ++k) mark(bricks, {i, j, k}, i == 9 ? kOccupied : kFree);
    }
  }
  const ObservedFreeSpace free = ObservedFreeSpace::known(map_of(bricks), 0.1);
  EXPECT_TRUE(free.contains({0.35, 0.15, -0.15}));
  EXPECT_TRUE(free.contains({1.25, 0.15, -0.35}));
  EXPECT_FALSE(free.contains({0.85, 0.15, -0.15}));  // shares its block with what is occupied
  EXPECT_FALSE(free.contains({0.35, 0.45, -0.15}));  // unknown
  EXPECT_FALSE(free.contains({0.35, 0.15, 0.15}));
}

TEST(ObservedFreeSpace, OfACloudLiesBetweenSurfacesThatFaceEachOther) {
  const AlignMap map = cloud_map(room());
  EXPECT_TRUE(map.free.contains({0.0, -1.4, 1.2}));   // in the room
  EXPECT_FALSE(map.free.contains({0.0, 3.0, 1.2}));   // behind a wall
  EXPECT_FALSE(map.free.contains({0.0, 0.0, 3.2}));   // over the ceiling
  EXPECT_FALSE(map.free.contains({-3.0, 0.0, 1.2}));  // in a wall
}

TEST(ObservedFreeSpace, TurnsNormalsIntoTheRoom) {
  const AlignMap map = cloud_map(room());
  std::size_t into = 0;
  std::size_t out_of = 0;
  for (const SurfaceCell& cell : map.fine().cells()) {
    if (!cell.one_sided || std::abs(cell.mean.x() + 3.0F) > 0.05F || std::abs(cell.mean.y()) > 1.5F) continue;
    (cell.normal.x() > 0.0F ? into : out_of) += 1;
  }
  EXPECT_GT(into, 100U);
  EXPECT_EQ(out_of, 0U);
}

TEST(Upright, IsWhatFloorsAndWallsSay) {
  const Transform tilt = transform(0.0, 0.0, 0.0, 0.0, degrees(2), degrees(-2));
  const AlignMap map = cloud_map(moved(room(), tilt));
  const Eigen::Vector3d up = map.R_upright_map * tilt.linear() * Eigen::Vector3d::UnitZ();
  EXPECT_LT(std::acos(std::min(1.0, up.z())), degrees(0.2));
  // A ramp of 30 degrees is no floor.
  EXPECT_TRUE(cloud_map(moved(room(), transform(0, 0, 0, 0, degrees(30)))).R_upright_map.isIdentity());
}

TEST(Gicp, RecoversASmallMotion) {
  const AlignMap map = cloud_map(room());
  const Transform off = transform(0.03, -0.02, 0.02, degrees(1), degrees(0.5), degrees(-0.5));
  const GicpResult result = refine(map.fine(), map.fine().cells(), off, {.kernel = 0.05, .max_iterations = 30});
  EXPECT_LT(metres_off(result.T_target_source, Transform::Identity()), 0.002);
  EXPECT_LT(degrees_off(result.T_target_source, Transform::Identity()), 0.05);
  EXPECT_LE(result.iterations, 30);
  const GicpResult none = refine(map.fine(), {}, off, {});
  EXPECT_EQ(none.pairs, 0U);
  EXPECT_TRUE(none.T_target_source.isApprox(off));
}

RC_GTEST_PROP(WallGrid, BoundsEveryValueOfAWindow, ()) {
  static const AlignMap kMap = cloud_map(room());
  static const WallGrid kGrid(kMap, Eigen::Matrix3d::Identity(), 0.1);
  const int level = *rc::gen::inRange(0, WallGrid::kLevels);
  const int x = kGrid.origin().x() + *rc::gen::inRange(-50, kGrid.size().x() + 50);
  const int y = kGrid.origin().y() + *rc::gen::inRange(-50, kGrid.size().y() + 50);
  int largest = std::numeric_limits<int>::min();
  for (int dy = 0; dy < 1 << level; ++dy) {
    for (int dx = 0; dx < 1 << level; ++dx) largest = std::max(largest, kGrid.at(0, x + dx, y + dy));
  }
  RC_ASSERT(kGrid.at(level, x, y) == largest);
}

TEST(BlockSet, HoldsWhatWasPutIn) {
  BlockSet set;
  set.insert({-1, 0, 5});
  set.insert({100'000, -100'000, 3});
  EXPECT_TRUE(set.contains({-1, 0, 5}));
  EXPECT_TRUE(set.contains({100'000, -100'000, 3}));
  EXPECT_FALSE(set.contains({0, 0, 5}));
  EXPECT_FALSE(set.contains({-1, 0, 4}));
}

RC_GTEST_PROP(CellTable, NumbersCellsInTheOrderOfTheirNames, ()) {
  const auto names = *rc::gen::container<std::vector<std::tuple<int, int, int>>>(
      rc::gen::tuple(rc::gen::inRange(-40, 40), rc::gen::inRange(-40, 40), rc::gen::inRange(-40, 40)));
  CellTable table;
  std::map<VoxelIndex, int> expected;
  for (const auto& [x, y, z] : names) {
    const auto [it, is_new] = expected.try_emplace(VoxelIndex{x, y, z}, static_cast<int>(expected.size()));
    RC_ASSERT(table.insert({x, y, z}) == it->second);
  }
  RC_ASSERT(table.cells().size() == expected.size());
  CellTable::Cursor cursor(table);
  for (const auto& [cell, number] : expected) {
    RC_ASSERT(table.find(cell) == number);
    RC_ASSERT(cursor.find(cell) == number);
    RC_ASSERT(cursor.find({cell.x + 100, cell.y, cell.z}) == -1);
  }
}

RC_GTEST_PROP(CellOf, IsVoxelOf, ()) {
  const auto coordinate = [] { return (*rc::gen::inRange(-2'000'000, 2'000'001)) * 0.25; };
  const Eigen::Vector3d p(coordinate(), coordinate(), coordinate());
  RC_ASSERT(cell_of(p, 2.0) == voxel_of(p, 0.5));
}

RC_GTEST_PROP(Spread, TakesEachPartOnce, ()) {
  const auto count = static_cast<std::size_t>(*rc::gen::inRange(1, 5000));
  const auto take = 1 + static_cast<std::size_t>(*rc::gen::inRange(0, 5000)) % count;
  for (std::size_t i = 0; i < take; ++i) {
    const std::size_t at = spread(i, take, count);
    RC_ASSERT(at >= i * count / take);
    RC_ASSERT(at <= ((i + 1) * count - 1) / take);
    RC_ASSERT(at < count);
    if (i > 0) RC_ASSERT(at >= spread(i - 1, take, count));
  }
}

TEST(Workers, DoEveryChunkOnce) {
  for (const int threads : {-1, 0, 1, 2, 7}) {
    std::vector<std::atomic<int>> done(100);
    for_each_chunk(threads, done.size(), [&](std::size_t chunk) { ++done[chunk]; });
    for (const std::atomic<int>& times : done) EXPECT_EQ(times, 1);
  }
  for_each_chunk(4, 0, [](std::size_t) { FAIL(); });
}

}  // namespace
}  // namespace concord::test
