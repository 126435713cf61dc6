#include <gtest/gtest.h>

#include <random>

#include "core/scan.hpp"
#include "stock_octomap.hpp"

namespace concord {
namespace {

using namespace test;

std::size_t different(const BrickMap& a, const BrickMap& b) {
  std::size_t count = 0;
  a.for_each_brick([&](BrickIndex index, const Brick& brick) {
    // OctoMap adds in real numbers, we in 1/1024: a few of these after a few scans.
    brick.for_each([&](int local, LogOdds l) { count += std::abs(l - b.at(voxel_at(index, local))) > 4; });
  });
  return count;
}

TEST(Scan, GivesTheMapOfStockOctomapButForRoundingAtEdges) {
  constexpr double kResolution = 0.1;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> within(-4.0f, 4.0f);
  octomap::OcTree tree(kResolution);
  tree.setProbHit(octomap::probability(to_double(kHit)));
  tree.setProbMiss(octomap::probability(to_double(kMiss)));
  BrickMap map;
  for (int round = 0; round < 4; ++round) {
    Scan scan{Transform::Identity(), 3.0, {}};
    scan.T_agent_sensor->translation() = Eigen::Vector3d(0.31, 0.22, 0.13) * round;
    octomap::Pointcloud cloud;
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector3f p(within(random), within(random), within(random));
      scan.points.push_back(p);
      cloud.push_back(p.x(), p.y(), p.z());
    }
    const Eigen::Vector3f origin = scan.T_agent_sensor->translation().cast<float>();
    tree.insertPointCloud(cloud, octomap::point3d(origin.x(), origin.y(), origin.z()), scan.max_range);
    ASSERT_TRUE(integrate(map, kResolution, checked(scan, kResolution)->scan).has_value());
  }
  const BrickMap stock = expanded(tree, StockValues::kLogOdds);
  ASSERT_GT(stock.known_count(), 30'000u);
  EXPECT_LT(different(map, stock), stock.known_count() / 500);
  EXPECT_LT(different(stock, map), stock.known_count() / 500);
}

}  // namespace
}  // namespace concord
