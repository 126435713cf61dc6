#include "merge/conflict_report.hpp"

#include <random>

#include <gtest/gtest.h>

#include "core/tile_puller.hpp"

namespace concord {
namespace {

constexpr double kResolution = 0.1;

class ConflictReportTest : public ::testing::Test {
 protected:
  ConflictReportTest() {
    for (const char* agent : {"a", "b", "c"}) {
      map_.begin_layer(agent, "f", 1);
      map_.place(agent, Transform::Identity());
    }
  }
  void claim(const std::string& agent, BrickIndex brick, std::uint64_t bits, LogOdds value) {
    VoxelMask mask{};
    mask[0] = bits;
    map_.set_brick(agent, brick, Brick::uniform(mask, value));
  }
  ConflictReport report(std::size_t most = 100) {
    map_.refold();
    return report_conflicts(map_, most);
  }

  PinMap pins_;
  LayeredMap map_{kResolution, Policy::kMean, pins_};
};

TEST_F(ConflictReportTest, NothingContradictsAnEmptyMap) {
  const ConflictReport none = report();
  EXPECT_EQ(none.regions_in_all, 0);
  EXPECT_TRUE(none.regions.empty());
}

TEST_F(ConflictReportTest, SaysWhoClaimsWhatWhere) {
  claim("a", {0, 0, 0}, 0b1110, kOccupied);
  claim("b", {0, 0, 0}, 0b0111, kFree);
  claim("c", {0, 0, 0}, 0b0010, kFree);
  const ConflictReport found = report();
  ASSERT_EQ(found.regions.size(), 1u);
  EXPECT_EQ(found.voxels_in_all, 2);
  const ConflictRegion& region = found.regions[0];
  EXPECT_EQ(region.voxels, 2);
  EXPECT_EQ(region.min, (VoxelIndex{1, 0, 0}));
  EXPECT_EQ(region.max, (VoxelIndex{2, 0, 0}));
  ASSERT_EQ(region.claims.size(), 3u);
  EXPECT_EQ(region.claims[0].agent, "a");
  EXPECT_EQ(region.claims[0].occupied, 2);
  EXPECT_EQ(region.claims[0].free, 0);
  EXPECT_EQ(region.claims[1].free, 2);
  EXPECT_EQ(region.claims[2].free, 1);
}

TEST_F(ConflictReportTest, ListsTheLargestFirstAndCountsAll) {
  for (int i = 0; i < 5; ++i) {
    const std::uint64_t bits = (1u << (i + 1)) - 1;
    claim("a", {i * 4, 0, 0}, bits, kOccupied);
    claim("b", {i * 4, 0, 0}, bits, kFree);
  }
  const ConflictReport found = report(2);
  EXPECT_EQ(found.regions_in_all, 5);
  EXPECT_EQ(found.voxels_in_all, 15);
  ASSERT_EQ(found.regions.size(), 2u);
  EXPECT_EQ(found.regions[0].voxels, 5);
  EXPECT_EQ(found.regions[1].voxels, 4);
}

TEST_F(ConflictReportTest, APinAndNewerDataEachEndAConflict) {
  claim("a", {0, 0, 0}, 0b11, kOccupied);
  claim("b", {0, 0, 0}, 0b11, kFree);
  EXPECT_EQ(report().voxels_in_all, 2);
  pins_.set(VoxelIndex{0, 0, 0}, PinMap::Pin::kDeleted);
  BrickSet touched;
  touched.insert(BrickIndex{0, 0, 0});
  map_.mark(touched);
  EXPECT_EQ(report().voxels_in_all, 1) << "a person has decided";
  claim("a", {0, 0, 0}, 0b11, kFree);
  EXPECT_EQ(report().regions_in_all, 0) << "they agree now";
}

/// Counted voxel by voxel from each layer alone, brought into the map.
TEST_F(ConflictReportTest, AgreesWithCountingByHandUnderRotation) {
  std::mt19937 random(3);
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  map_.place("b", T);
  for (int i = 0; i < 200; ++i) {
    const auto c = [&] { return static_cast<std::int32_t>(random() % 8) - 4; };
    VoxelMask mask;
    for (std::uint64_t& word : mask) word = random() | std::uint64_t{random()} << 32;
    map_.set_brick(i % 2 == 0 ? "a" : "b", {c(), c(), c()}, Brick::uniform(mask, i % 3 == 0 ? kOccupied : kFree));
  }
  const ConflictReport found = report(1000);
  ASSERT_GT(found.regions_in_all, 3);
  std::map<std::string, BrickMap> alone;
  for (const auto& [agent, layer] : map_.layers()) {
    const Layer one{&layer.map, *layer.T_map_agent, 1};
    alone[agent] = compose({&one, 1}, PinMap{}, Policy::kMean, kResolution).values;
  }
  std::int64_t voxels = 0;
  for (const ConflictRegion& region : found.regions) {
    std::map<std::string, std::pair<int, int>> counted;
    map_.conflicts().for_each_brick([&](BrickIndex index, const Brick& brick) {
      if (tile_of(index) != tile_of(brick_of(region.min))) return;
      brick.for_each([&](int local, LogOdds) {
        for (const auto& [agent, map] : alone) {
          const LogOdds l = map.at(voxel_at(index, local));
          counted[agent].first += is_occupied(l) ? 1 : 0;
          counted[agent].second += is_free(l) ? 1 : 0;
        }
      });
    });
    std::erase_if(counted, [](const auto& entry) { return entry.second == std::pair{0, 0}; });
    ASSERT_EQ(region.claims.size(), counted.size());
    for (const auto& claim : region.claims) {
      EXPECT_EQ(claim.occupied, counted.at(claim.agent).first);
      EXPECT_EQ(claim.free, counted.at(claim.agent).second);
    }
    voxels += region.voxels;
  }
  EXPECT_EQ(voxels, found.voxels_in_all);
}

}  // namespace
}  // namespace concord
