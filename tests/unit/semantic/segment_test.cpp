#include "semantic/segmentation/segment.hpp"

#include <gtest/gtest.h>

#include "sample_meshes.hpp"
#include "semantic/models/solid_voxels.hpp"

namespace concord {
namespace {

constexpr double kResolution = 0.05;

BrickMasks box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return voxelize(box_mesh(low, high), {}, kResolution, Fill::kSurface)->surface;
}

/// A room of 5 m x 4 m x 2.5 m with a table, a cupboard beside it, a screen on the table, and a couch.
struct Room {
  BrickMasks shell = box({0.01, 0.01, 0.01}, {5.01, 4.01, 2.51});
  BrickMasks top = box({1.01, 1.01, 0.71}, {2.41, 1.81, 0.74});
  BrickMasks leg = box({1.11, 1.11, 0.06}, {1.14, 1.14, 0.70});
  BrickMasks screen = box({1.51, 1.31, 0.81}, {2.11, 1.34, 1.21});
  BrickMasks seat = box({3.51, 2.01, 0.06}, {4.11, 3.51, 0.41});
  BrickMasks back = box({4.11, 2.01, 0.06}, {4.31, 3.51, 0.81});

  [[nodiscard]] BrickMasks all() const {
    BrickMasks out = shell;
    for (const BrickMasks* part : {&top, &leg, &screen, &seat, &back}) out.insert(*part);
    return out;
  }
};

double share_of(const BrickMasks& part, const BrickMasks& whole) {
  BrickMasks left = part;
  left.erase(whole);
  return 1.0 - static_cast<double>(left.count()) / static_cast<double>(part.count());
}

TEST(Segment, ATouchOnATableIsTheTableAndNotWhatStandsOnItNorTheFloor) {
  const Room room;
  const auto proposal = propose_object(room.all(), kResolution, {1.2, 1.2, 0.74});
  ASSERT_TRUE(proposal);
  EXPECT_EQ(proposal->kind, Proposal::Kind::kFlatTopped);
  EXPECT_GT(share_of(room.top, proposal->voxels), 0.95);
  EXPECT_GT(share_of(room.leg, proposal->voxels), 0.9);
  EXPECT_LT(share_of(room.screen, proposal->voxels), 0.1);
  EXPECT_EQ(share_of(room.shell, proposal->voxels), 0.0);
  EXPECT_EQ(share_of(room.seat, proposal->voxels), 0.0);
}

TEST(Segment, WhatIsBetweenATableAndItsWallIsTheTables) {
  const Room room;
  const BrickMasks desk = box({0.21, 2.51, 0.71}, {1.01, 3.51, 0.74});  // three columns from the wall
  const BrickMasks edge = box({0.11, 2.51, 0.51}, {0.19, 3.51, 0.54});  // where it was hardly seen
  const BrickMasks apart = box({1.31, 2.51, 0.51}, {1.34, 3.51, 0.54});
  BrickMasks all = room.all();
  for (const BrickMasks* part : {&desk, &edge, &apart}) all.insert(*part);
  const auto proposal = propose_object(all, kResolution, {0.6, 3.0, 0.74});
  ASSERT_TRUE(proposal);
  EXPECT_GT(share_of(desk, proposal->voxels), 0.95);
  EXPECT_GT(share_of(edge, proposal->voxels), 0.9);
  EXPECT_EQ(share_of(apart, proposal->voxels), 0.0);
  EXPECT_EQ(share_of(room.shell, proposal->voxels), 0.0);
}

TEST(Segment, ATouchOnAScreenIsTheScreen) {
  const Room room;
  const auto proposal = propose_object(room.all(), kResolution, {1.8, 1.3, 1.0});
  ASSERT_TRUE(proposal);
  EXPECT_GT(share_of(room.screen, proposal->voxels), 0.9);
  EXPECT_LT(share_of(room.top, proposal->voxels), 0.05);
}

TEST(Segment, ATouchOnASeatIsTheCouchWithItsBack) {
  const Room room;
  const auto proposal = propose_object(room.all(), kResolution, {3.8, 2.8, 0.41});
  ASSERT_TRUE(proposal);
  EXPECT_GT(share_of(room.seat, proposal->voxels), 0.9);
  EXPECT_GT(share_of(room.back, proposal->voxels), 0.9);
  EXPECT_EQ(share_of(room.shell, proposal->voxels), 0.0);
}

TEST(Segment, AFloorThatIsSeenThreeVoxelsThickIsNoObject) {
  const Room room;
  BrickMasks all = room.all();
  for (const double z : {0.06, 0.11}) all.insert(box({0.11, 0.11, z}, {4.91, 3.91, z + 0.001}));
  EXPECT_EQ(propose_object(all, kResolution, {2.9, 0.6, 0.1}).error().code, Code::kEmpty);
  const auto proposal = propose_object(all, kResolution, {3.8, 2.8, 0.41});
  ASSERT_TRUE(proposal);
  EXPECT_GT(share_of(room.back, proposal->voxels), 0.8);  // 14 of its 17 layers: the lowest are in the floor
  EXPECT_LT(proposal->voxels.count(), 2 * (room.seat.count() + room.back.count()));
}

TEST(Segment, WithoutACeilingTheHighestThingIsStillNoWall) {
  BrickMasks floor = box({0.01, 0.01, 0.01}, {5.01, 4.01, 0.02});
  floor.insert(box({0.01, 0.01, 0.01}, {0.02, 4.01, 0.99}));  // a wall as high as the map
  const auto solid = voxelize(box_mesh({2.01, 1.51, 0.06}, {2.79, 2.29, 0.99}), {}, kResolution, Fill::kSolid);
  BrickMasks crate = solid->surface;
  crate.insert(solid->interior);
  BrickMasks all = floor;
  all.insert(crate);
  const auto proposal = propose_object(all, kResolution, {2.4, 1.9, 0.5});
  ASSERT_TRUE(proposal);
  EXPECT_GT(share_of(crate, proposal->voxels), 0.95);
  EXPECT_EQ(share_of(floor, proposal->voxels), 0.0);
  EXPECT_EQ(propose_object(all, kResolution, {0.02, 0.5, 0.6}).error().code, Code::kEmpty);
}

TEST(Segment, TouchingAWallFarFromAllProposesNothing) {
  EXPECT_EQ(propose_object(Room().all(), kResolution, {0.01, 3.5, 1.5}).error().code, Code::kEmpty);
  EXPECT_EQ(propose_object({}, kResolution, {0, 0, 0}).error().code, Code::kEmpty);
  EXPECT_EQ(propose_object(Room().all(), kResolution, {std::nan(""), 0, 0}).error().code, Code::kOutOfBounds);
  EXPECT_EQ(propose_object(Room().all(), kResolution, {1e9, 0, 0}).error().code, Code::kOutOfBounds);
}

TEST(Segment, WhatLiesInReachIsAllThatATouchLooksAt) {
  BrickMap map = Room().all().to_map(kOccupied);
  const Eigen::Vector3d seed(1.2, 1.2, 0.74);
  const auto alone = propose_object(occupied_of(map), kResolution, seed);
  // Far away is much, then little: the box is less than the map, then the other way round.
  for (const int far : {200, 8000}) {
    map.set({far, 0, 0}, Brick::uniform(VoxelMask{1}, kOccupied));
    for (int i = 0; far == 200 && i < 30'000; ++i) {
      map.set({200 + i % 200, i / 200, 3}, Brick::uniform(VoxelMask{1}, kOccupied));
    }
    const BrickMasks around = occupied_around(map, reach_of_touch(seed, kResolution));
    EXPECT_EQ(around.sorted(), Room().all().sorted());
    EXPECT_EQ(propose_object(around, kResolution, seed)->voxels.sorted(), alone->voxels.sorted());
    if (far == 200) map = Room().all().to_map(kOccupied);
  }
}

TEST(Segment, IsTheSameEachTime) {
  const Room room;
  const auto a = propose_object(room.all(), kResolution, {1.8, 1.3, 1.0});
  const auto b = propose_object(room.all(), kResolution, {1.8, 1.3, 1.0});
  EXPECT_EQ(a->voxels.voxels(), b->voxels.voxels());
}

}  // namespace
}  // namespace concord
