#include "core/brick_map.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "scene.hpp"

namespace concord {
namespace {

TEST(Brick, KeepsEachVoxelOfADenseOne) {
  EXPECT_TRUE(rc::check([](std::uint32_t seed) {
    std::mt19937 random(seed);
    const int density = *rc::gen::inRange(0, 101);
    const bool is_uniform = *rc::gen::arbitrary<bool>();
    DenseBrick dense;
    VoxelMask occupied{};
    int known = 0;
    for (int i = 0; i < kBrickVoxels; ++i) {
      const bool is_set = static_cast<int>(random() % 100) < density;
      const auto value = static_cast<LogOdds>(is_uniform ? 5 : static_cast<int>(random() % 65535) - 32767);
      dense[i] = is_set ? value : kUnknown;
      known += is_set;
      occupied[i / 64] |= std::uint64_t{is_set && value >= 0} << (i % 64);
    }
    const Brick brick = Brick::from_dense(dense);
    RC_ASSERT(brick.known_count() == known);
    RC_ASSERT(brick.occupied() == occupied);
    RC_ASSERT(brick.is_uniform() || !is_uniform);
    DenseBrick back;
    brick.to_dense(back);
    RC_ASSERT(back == dense);
    for (int i = 0; i < kBrickVoxels; ++i) RC_ASSERT(brick.at(i) == dense[i]);
    RC_ASSERT(Brick(brick) == brick);
  }));
}

TEST(BrickMap, TakesBricksOrWholeTilesToTheSameContent) {
  EXPECT_TRUE(rc::check([](std::uint32_t seed) {
    const BrickMap map = testing::random_scene(seed).layers[0].map;
    BrickMap by_tiles;
    BrickMap backwards;
    for (const TileIndex index : map.sorted_tiles()) by_tiles.set(index, Tile(*map.find(index)));
    std::vector<BrickIndex> bricks = map.sorted_bricks();
    for (auto it = bricks.rbegin(); it != bricks.rend(); ++it) RC_ASSERT(backwards.set(*it, *map.find(*it)));
    RC_ASSERT(by_tiles == map);
    RC_ASSERT(backwards == map);
    RC_ASSERT(digest(backwards) == digest(map));
    RC_ASSERT(by_tiles.brick_count() == bricks.size());

    const TileIndex gone = map.sorted_tiles().front();
    by_tiles.set(gone, Tile{});
    for (const BrickIndex index : bricks) {
      if (tile_of(index) == gone) RC_ASSERT(backwards.set(index, Brick{}));
    }
    RC_ASSERT(by_tiles == backwards);
    RC_ASSERT(by_tiles.brick_count() == backwards.brick_count());
    RC_ASSERT(digest(backwards) != digest(map));
  }));
}

TEST(BrickMap, SaysWhetherAnythingChanged) {
  BrickMap map;
  const Brick brick = Brick::uniform({1}, kFree);
  EXPECT_FALSE(map.set(BrickIndex{1, 2, 3}, Brick{}));
  EXPECT_TRUE(map.set(BrickIndex{1, 2, 3}, brick));
  EXPECT_FALSE(map.set(BrickIndex{1, 2, 3}, brick));
  EXPECT_TRUE(map.set(BrickIndex{1, 2, 3}, Brick::uniform({1}, kOccupied)));
  EXPECT_EQ(map.at({8, 16, 24}), kOccupied);
  EXPECT_TRUE(map.set(BrickIndex{1, 2, 3}, Brick{}));
  EXPECT_TRUE(map.empty());
}

}  // namespace
}  // namespace concord
