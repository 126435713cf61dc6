#include "core/downsample.hpp"

#include <gtest/gtest.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

#include "arbitrary.hpp"

namespace concord {
namespace {

using namespace test;

std::vector<Eigen::Vector3f> by_pcl(const BrickMap& map, double resolution, double cell_size) {
  const auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  map.for_each_brick([&](BrickIndex index, const Brick& brick) {
    brick.for_each([&](int local, LogOdds l) {
      if (!is_occupied(l)) return;
      const Eigen::Vector3f p = centre_of(voxel_at(index, local), resolution).cast<float>();
      cloud->emplace_back(p.x(), p.y(), p.z());
    });
  });
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  const auto leaf = static_cast<float>(cell_size);
  grid.setLeafSize(leaf, leaf, leaf);
  grid.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointXYZ> result;
  grid.filter(result);
  std::vector<Eigen::Vector3f> points;
  for (const auto& p : result) points.emplace_back(p.x, p.y, p.z);
  return points;
}

/// Whether each point of `a` has its own partner in `b` within 1e-4 m.
bool same_points(std::vector<Eigen::Vector3f> a, std::vector<Eigen::Vector3f> b) {
  if (a.size() != b.size()) return false;
  for (const Eigen::Vector3f& p : a) {
    const auto partner = std::find_if(b.begin(), b.end(), [&](const auto& q) { return (p - q).norm() < 1e-4f; });
    if (partner == b.end()) return false;
    b.erase(partner);
  }
  return true;
}

RC_GTEST_PROP(Downsample, IsWhatPclsVoxelGridMakesOfTheCentres, ()) {
  const BrickMap map = *arbitrary_map(12);
  const double cell_size = *rc::gen::element(0.5, 0.3, 0.17, 1.0, 0.05, 0.07);
  RC_ASSERT(same_points(downsample(map, 0.05, cell_size), by_pcl(map, 0.05, cell_size)));
}

TEST(Downsample, IsSortedByCellAndHoldsOneCentroidEach) {
  VoxelMask all;
  all.fill(~std::uint64_t{0});
  BrickMap map;
  map.set({-1, 0, 0}, Brick::uniform(all, kOccupied));
  map.set({0, 0, 0}, Brick::uniform(all, kOccupied));
  map.set({5, 5, 5}, Brick::uniform(all, kFree));
  const auto points = downsample(map, 0.1, 0.8);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_TRUE(points[0].isApprox(Eigen::Vector3f(-0.4f, 0.4f, 0.4f)));
  EXPECT_TRUE(points[1].isApprox(Eigen::Vector3f(0.4f, 0.4f, 0.4f)));
}

TEST(Downsample, ReachesFurtherThanPclsCellNumbers) {
  BrickMap map;
  for (const std::int32_t i : {-100'000, 100'000}) map.set({i, i, i}, Brick::uniform({3}, kOccupied));
  EXPECT_EQ(downsample(map, 0.05, 0.2).size(), 2u) << "PCL would answer all four points";
}

}  // namespace
}  // namespace concord
