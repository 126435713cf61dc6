#include "core/pins.hpp"

#include <gtest/gtest.h>

namespace concord {
namespace {

TEST(PinMap, TheLatestPinOfAVoxelCounts) {
  PinMap pins;
  const VoxelIndex voxel{-3, 70, 5};
  EXPECT_EQ(pins.at(voxel), PinMap::Pin::kNone);
  pins.set(voxel, PinMap::Pin::kAdded);
  pins.set(voxel, PinMap::Pin::kDeleted);
  EXPECT_EQ(pins.at(voxel), PinMap::Pin::kDeleted);
  ASSERT_NE(pins.find(brick_of(voxel)), nullptr);
  EXPECT_EQ(pins.find(brick_of(voxel))->occupied, VoxelMask{});
}

TEST(PinMap, KeepsNoBrickWithoutPins) {
  PinMap pins;
  pins.set({1, 1, 1}, PinMap::Pin::kNone);
  pins.set({1, 1, 1}, PinMap::Pin::kAdded);
  pins.set({100, 1, 1}, PinMap::Pin::kAdded);
  EXPECT_EQ(pins.sorted_bricks(), (std::vector<BrickIndex>{{0, 0, 0}, {12, 0, 0}}));
  pins.set({1, 1, 1}, PinMap::Pin::kNone);
  pins.set({100, 1, 1}, PinMap::Pin::kNone);
  EXPECT_TRUE(pins.empty());
}

}  // namespace
}  // namespace concord
