#include "merge/layered_map.hpp"

#include <random>

#include <gtest/gtest.h>

namespace concord {
namespace {

constexpr double kResolution = 0.1;

Brick some_brick(int seed) {
  std::mt19937 random(seed);
  DenseBrick dense;
  for (LogOdds& l : dense) l = random() % 2 == 0 ? kUnknown : static_cast<LogOdds>(random() % 4000 - 2000);
  return Brick::from_dense(dense);
}

class LayeredMapTest : public ::testing::Test {
 protected:
  PinMap pins_;
  LayeredMap map_{kResolution, Policy::kMean, pins_};
};

TEST_F(LayeredMapTest, TellsExactlyWhatChanged) {
  map_.begin_layer("a", "f", 1);
  map_.place("a", Transform::Identity());
  map_.set_brick("a", {0, 0, 0}, some_brick(1));
  EXPECT_EQ(map_.refold().map, std::vector<BrickIndex>({{0, 0, 0}}));
  EXPECT_TRUE(map_.refold().map.empty());
  map_.set_brick("a", {0, 0, 0}, *map_.find("a")->map.find(BrickIndex{0, 0, 0}));
  EXPECT_TRUE(map_.refold().map.empty()) << "a brick sent again changes nothing";
}

TEST_F(LayeredMapTest, KeepsWhatIsNotAlignedOutside) {
  map_.begin_layer("a", "f", 1);
  map_.set_brick("a", {0, 0, 0}, some_brick(2));
  map_.refold();
  EXPECT_TRUE(map_.map().empty());
  map_.place("a", Transform::Identity());
  map_.refold();
  EXPECT_FALSE(map_.map().empty());
  map_.begin_layer("a", "g", 1);
  map_.refold();
  EXPECT_TRUE(map_.map().empty()) << "a new frame leaves no ghost of the one before";
}

TEST_F(LayeredMapTest, AWeightRefoldsWhereItsAgentIsAndNowhereElse) {
  for (const char* agent : {"a", "b"}) {
    map_.begin_layer(agent, "f", 1);
    map_.place(agent, Transform::Identity());
  }
  VoxelMask mask{};
  mask[0] = 1;
  map_.set_brick("a", {0, 0, 0}, Brick::uniform(mask, 1000));
  map_.set_brick("b", {0, 0, 0}, Brick::uniform(mask, -1000));
  map_.set_brick("b", {9, 0, 0}, Brick::uniform(mask, -1000));
  map_.refold();
  EXPECT_EQ(map_.map().at({0, 0, 0}), 0);
  map_.set_weight("a", 3);
  EXPECT_EQ(map_.refold().map, std::vector<BrickIndex>({{0, 0, 0}}));
  EXPECT_EQ(map_.map().at({0, 0, 0}), 500);
}

TEST_F(LayeredMapTest, CountsVoxels) {
  map_.begin_layer("a", "f", 1);
  VoxelMask mask{};
  mask[0] = 0b111;
  map_.set_brick("a", {0, 0, 0}, Brick::uniform(mask, kOccupied));
  mask[0] = 0b11;
  map_.set_brick("a", {1, 0, 0}, Brick::uniform(mask, kFree));
  EXPECT_EQ(map_.find("a")->known, 5);
  EXPECT_EQ(map_.find("a")->occupied, 3);
  map_.set_brick("a", {0, 0, 0}, Brick{});
  EXPECT_EQ(map_.find("a")->known, 2);
  EXPECT_EQ(map_.find("a")->occupied, 0);
}

}  // namespace
}  // namespace concord
