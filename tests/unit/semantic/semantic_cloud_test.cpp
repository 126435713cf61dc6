#include "semantic/labels/semantic_cloud.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

/// As a user of PCL would write it.
struct StockPoint {
  float x, y, z, probability;
  std::uint32_t label, instance;
};
POINT_CLOUD_REGISTER_POINT_STRUCT(StockPoint, (float, x, x)(float, y, y)(float, z, z)(float, probability, probability)(
                                                  std::uint32_t, label, label)(std::uint32_t, instance, instance))

namespace concord {
namespace {

SemanticCloud sample() {
  BrickMap map, labels;
  map.set({0, 0, 0}, Brick::uniform({0xFF00FF, 0, 3, 0, 0, 0, 0, 1}, kOccupied));
  map.set({-5, 2, -1}, Brick::uniform({7, 0, 0, 0, 0, 0, 0, 0}, to_log_odds(0.7)));
  map.set({9, 9, 9}, Brick::uniform({7, 0, 0, 0, 0, 0, 0, 0}, kFree));
  labels.set({0, 0, 0}, Brick::uniform({0xF, 0, 0, 0, 0, 0, 0, 0}, value_of_slot(0)));
  labels.set({-5, 2, -1}, Brick::uniform({2, 0, 0, 0, 0, 0, 0, 0}, value_of_slot(65'534)));
  return *semantic_cloud(map, labels, {{0, {3, 1}, "chair"}, {65'534, {4'000'000, 77}, "Tür, 2. Stock"}}, 0.05);
}

TEST(SemanticCloud, HoldsEachOccupiedVoxelWithItsLabel) {
  const SemanticCloud cloud = sample();
  ASSERT_EQ(cloud.points.size(), 16U + 2 + 1 + 3);
  EXPECT_EQ(std::ranges::count_if(cloud.points, [](const auto& p) { return p.label == 3; }), 4);
  const auto instances = instances_of(cloud);
  EXPECT_EQ(instances->at({3, 1}), (std::vector<VoxelIndex>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}));
  EXPECT_EQ(instances->at({4'000'000, 77}), (std::vector<VoxelIndex>{{-39, 16, -8}}));
}

TEST(SemanticCloud, ComesBackEqualFromBothKindsOfFile) {
  for (const SemanticCloud& cloud : {sample(), SemanticCloud{0.1, {}, {}}}) {
    const Bytes pcd = write_pcd(cloud), ply = write_ply(cloud);
    ASSERT_TRUE(read_pcd(pcd)) << read_pcd(pcd).error().message;
    ASSERT_TRUE(read_ply(ply)) << read_ply(ply).error().message;
    EXPECT_EQ(*read_pcd(pcd), cloud);
    EXPECT_EQ(*read_ply(ply), cloud);
    EXPECT_EQ(write_pcd(*read_pcd(pcd)), pcd);
    EXPECT_EQ(write_ply(*read_ply(ply)), ply);
  }
}

TEST(SemanticCloud, StockPclReadsEveryField) {
  const SemanticCloud cloud = sample();
  const auto file = std::filesystem::path(testing::TempDir()) / ("cloud-" + std::to_string(getpid()) + ".pcd");
  const Bytes bytes = write_pcd(cloud);
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  pcl::PointCloud<StockPoint> stock;
  ASSERT_EQ(pcl::io::loadPCDFile(file.string(), stock), 0);
  std::filesystem::remove(file);
  ASSERT_EQ(stock.size(), cloud.points.size());
  for (std::size_t i = 0; i < stock.size(); ++i) {
    const SemanticPoint seen{stock[i].x,           stock[i].y,     stock[i].z,
                             stock[i].probability, stock[i].label, stock[i].instance};
    EXPECT_EQ(seen, cloud.points[i]);
  }
}

TEST(SemanticCloud, RefusesWhatIsNotWhole) {
  const SemanticCloud cloud = sample();
  for (const auto& [bytes, read] : {std::pair(write_pcd(cloud), &read_pcd), std::pair(write_ply(cloud), &read_ply)}) {
    for (std::size_t n = 0; n < bytes.size(); n += 3) EXPECT_FALSE(read(ByteSpan(bytes).first(n))) << n;
    Bytes longer = bytes;
    longer.push_back(0);
    EXPECT_FALSE(read(longer));
  }
  SemanticCloud broken = cloud;
  broken.points[3].x = std::nanf("");
  EXPECT_EQ(read_pcd(write_pcd(broken)).error().code, Code::kNotFinite);
  broken = cloud;
  broken.points[3].label = 12;
  EXPECT_EQ(read_pcd(write_pcd(broken)).error().code, Code::kMalformed);
  std::string huge(reinterpret_cast<const char*>(write_pcd(cloud).data()), 400);
  EXPECT_FALSE(read_pcd(ByteSpan(reinterpret_cast<const std::uint8_t*>(huge.data()), huge.size())));
}

}  // namespace
}  // namespace concord
