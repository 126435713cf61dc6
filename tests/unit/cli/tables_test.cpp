#include <gtest/gtest.h>

#include "cli/conflicts.hpp"
#include "cli/extent.hpp"
#include "cli/paths.hpp"
#include "cli/status.hpp"
#include "cli/table.hpp"

namespace concord {
namespace {

TEST(Tables, ColumnsAreAsWideAsTheirWidestCellInCharacters) {
  EXPECT_EQ(format_table({{"a", "n"}, {"Tür", "10"}, {"", "5"}}, "lr"), "a     n\nTür  10\n      5\n");
}

TEST(Tables, VoxelsCoverSpaceAndNothingIsMinusZero) {
  EXPECT_EQ(to_words(extent({0, -1, 2}, {9, -1, 2}, 0.05)), "0.00..0.50  -0.05..0.00  0.10..0.15");
  EXPECT_EQ(to_words(Box{{-1e-9, 0, 0}, {1, 1, 1}}), "0.00..1.00  0.00..1.00  0.00..1.00");
}

TEST(Tables, AVolumeIsSeenAlongTheAxesOfTheMap) {
  const Transform T_map_volume = make_transform({10, 0, 0}, {0, 0, 0.70710678118654752, 0.70710678118654752}).value();
  EXPECT_EQ(to_words(extent(Box{{0, 0, 0}, {1, 2, 3}}, T_map_volume)), "8.00..10.00  0.00..1.00  0.00..3.00");
  EXPECT_EQ(to_words(extent(OrientedBox{T_map_volume, {2, 4, 6}}, Transform::Identity())),
            "8.00..12.00  -1.00..1.00  -3.00..3.00");
  EXPECT_EQ(to_words(extent(Prism{{{0, 0}, {2, 0}, {0, 1}}, -1, 1}, Transform::Identity())),
            "0.00..2.00  0.00..1.00  -1.00..1.00");
}

/// Of `voxels` that `first` holds occupied and `second` free.
ConflictRegion region(VoxelIndex min, VoxelIndex max, int voxels, const std::string& first = "cart1",
                      const std::string& second = "robot1") {
  return {min, max, voxels, {{first, voxels, 0}, {second, 0, voxels}}};
}

std::vector<ConflictList> listed(std::vector<ConflictRegion> regions, std::int64_t in_all) {
  std::vector<ConflictList> parts;
  for (ConflictRegion& one : regions) {
    parts.push_back({"c",
                     static_cast<std::int32_t>(parts.size()),
                     static_cast<std::int32_t>(regions.size()),
                     in_all,
                     1234,
                     {std::move(one)}});
  }
  return parts;
}

TEST(Tables, ConflictsSayWhoClaimsWhat) {
  const Conflicts found = joined(listed(
      {region({0, 0, 0}, {31, 31, 31}, 1200), region({64, 0, 0}, {64, 0, 0}, 1), region({96, 0, 0}, {96, 0, 0}, 1)},
      3));
  EXPECT_EQ(
      to_words(found, 2, 0.1),
      "1,234 voxels in conflict, in 3 regions; the 2 with the most\n"
      "voxels  where: x, y, z (m)                  who claims what\n"
      " 1,200  0.00..3.20  0.00..3.20  0.00..3.20  cart1: 1,200 occupied, 0 free; robot1: 0 occupied, 1,200 free\n"
      "     1  6.40..6.50  0.00..0.10  0.00..0.10  cart1: 1 occupied, 0 free; robot1: 0 occupied, 1 free\n");
  const nlohmann::json json = to_json(found, 2, 0.1);
  EXPECT_EQ(json["voxels_in_all"], 1234);
  EXPECT_EQ(json["regions_in_all"], 3);
  EXPECT_EQ(json["regions"].size(), 2U);
  EXPECT_EQ(json["regions"][0]["claims"][1]["agent"], "robot1");
  EXPECT_EQ(to_words(joined(std::vector{ConflictList{}}), 20, 0.1), "no conflicts");
}

TEST(Tables, AConflictAcrossTheBordersOfTilesIsOne) {
  // A wall over three tiles, one of them met at an edge only; another pair's conflict beside it; one with a gap.
  const Conflicts found = joined(listed(
      {region({10, 5, 0}, {31, 5, 20}, 100), region({32, 5, 0}, {63, 5, 20}, 300), region({64, 6, 21}, {70, 6, 30}, 50),
       region({71, 6, 0}, {72, 6, 20}, 7, "cart1", "headset"), region({10, 7, 0}, {31, 7, 20}, 9)},
      5));
  ASSERT_EQ(found.regions.size(), 3U);
  const ConflictRegion& wall = found.regions[0];
  EXPECT_EQ(wall.voxels, 450);
  EXPECT_EQ(wall.min, (VoxelIndex{10, 5, 0}));
  EXPECT_EQ(wall.max, (VoxelIndex{70, 6, 30}));
  EXPECT_EQ(wall.claims[0].occupied, 450);
  EXPECT_EQ(wall.claims[1].free, 450);
  EXPECT_EQ(found.regions[1].voxels, 9);
  EXPECT_EQ(found.regions[2].voxels, 7);
}

TEST(Tables, NoRegionOfConflictsGrowsOverAWholeBuilding) {
  std::vector<ConflictRegion> wall;
  for (int i = 0; i < 100; ++i) wall.push_back(region({32 * i, 0, 0}, {32 * i + 31, 0, 31}, 10));
  const Conflicts found = joined(listed(wall, 200));
  EXPECT_GE(found.regions.size(), 12U);
  int voxels = 0;
  for (const ConflictRegion& one : found.regions) {
    EXPECT_LE(one.max.x - one.min.x + 1, kLongestRegion);
    voxels += one.voxels;
  }
  EXPECT_EQ(voxels, 1000);
  EXPECT_LE(found.regions.size(), 60U);
  EXPECT_NE(to_words(found, 100, 0.1).find("in over "), std::string::npos) << "merge has listed half of them";
}

TEST(Tables, TheStatusNamesWhoIsMissing) {
  Statuses heard;
  for (const char* name : {"align", "ingest", "planner", "semantic"})
    heard[name] = {5'000'000, name, 1'000'000, {{"agents", 1}}};
  EXPECT_EQ(missing(heard), std::vector<std::string>{"merge"});
  EXPECT_EQ(to_json(heard)["missing"], nlohmann::json({"merge"}));
  EXPECT_NE(to_words(heard).find("merge  MISSING"), std::string::npos) << to_words(heard);
  heard["merge"] = {};
  EXPECT_TRUE(missing(heard).empty());
  EXPECT_EQ(to_words(heard).find("MISSING"), std::string::npos);
}

TEST(Tables, OnlyPathsThatAreKeptAreListed) {
  KeptPaths kept;
  Path path;
  path.id = "p1";
  path.robot = "robot1";
  path.status = "OK";
  path.points = {{0, 0, 0}, {3, 4, 0}};
  path.length = 5;
  path.least_clearance = 0.5;
  path.map_revision = 1;
  path.active = true;
  path.utime = 1;
  take(kept, path);
  Path question = path;
  question.id = "p2";
  question.active = false;
  take(kept, question);
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_NE(to_words(kept).find("3.00  4.00"), std::string::npos) << to_words(kept);
  EXPECT_EQ(to_json(kept)["paths"][0]["robot"], "robot1");
  path.active = false;
  take(kept, path);
  EXPECT_TRUE(kept.empty());
}

}  // namespace
}  // namespace concord
