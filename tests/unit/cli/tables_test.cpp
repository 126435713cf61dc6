#include <gtest/gtest.h>

#include "cli/conflicts.hpp"
#include "cli/extent.hpp"
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

TEST(Tables, ConflictsSayWhoClaimsWhat) {
  ConflictList first, second;
  first.parts = second.parts = 2;
  second.part = 1;
  first.regions_in_all = second.regions_in_all = 3;
  first.voxels_in_all = second.voxels_in_all = 1234;
  first.regions = {{{0, 0, 0}, {31, 31, 31}, 1200, {{"cart1", 1200, 0}, {"robot1", 0, 1100}}}};
  second.regions = {{{32, 0, 0}, {32, 0, 0}, 1, {{"cart1", 0, 1}, {"robot1", 1, 0}}}};
  EXPECT_EQ(
      to_words(std::vector{first, second}, 0.1),
      "1,234 voxels in conflict, in 3 regions; the 2 with the most\n"
      "voxels  where: x, y, z (m)                  who claims what\n"
      " 1,200  0.00..3.20  0.00..3.20  0.00..3.20  cart1: 1,200 occupied, 0 free; robot1: 0 occupied, 1,100 free\n"
      "     1  3.20..3.30  0.00..0.10  0.00..0.10  cart1: 0 occupied, 1 free; robot1: 1 occupied, 0 free\n");
  const nlohmann::json json = to_json(std::vector{first, second}, 0.1);
  EXPECT_EQ(json["voxels_in_all"], 1234);
  EXPECT_EQ(json["regions"].size(), 2U);
  EXPECT_EQ(json["regions"][0]["claims"][1]["agent"], "robot1");
  EXPECT_EQ(to_words(std::vector{ConflictList{}}, 0.1), "no conflicts");
}

}  // namespace
}  // namespace concord
