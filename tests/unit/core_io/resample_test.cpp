#include "core/resample.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <map>

#include "arbitrary.hpp"

namespace concord {
namespace {

using namespace test;

/// A resolution in millimetres, so that the oracle can reckon in integers.
struct Ratio {
  int source, target;
};

rc::Gen<Ratio> arbitrary_ratio() {
  return rc::gen::elementOf(std::vector<Ratio>{
      {50, 100}, {100, 50}, {50, 75}, {75, 50}, {80, 50}, {50, 80}, {150, 50}, {50, 150}, {20, 100}, {99, 100}});
}

int floor_div(int a, int b) { return static_cast<int>(std::floor(static_cast<double>(a) / b)); }

/// Cell of a lattice of `to` mm that holds the centre of cell `i` of a lattice of `from` mm.
int holding(int i, int from, int to) { return floor_div((2 * i + 1) * from, 2 * to); }

VoxelIndex holding(VoxelIndex v, int from, int to) {
  return {holding(v.x, from, to), holding(v.y, from, to), holding(v.z, from, to)};
}

RC_GTEST_PROP(Resample, ToACoarserLatticeTakesTheLargestOfTheContained, ()) {
  const Ratio r = *rc::gen::suchThat(arbitrary_ratio(), [](Ratio x) { return x.source < x.target; });
  const BrickMap map = *arbitrary_map(50);
  std::map<VoxelIndex, LogOdds> expected;
  map.for_each_brick([&](BrickIndex b, const Brick& brick) {
    brick.for_each([&](int local, LogOdds l) {
      LogOdds& most = expected.try_emplace(holding(voxel_at(b, local), r.source, r.target), kUnknown).first->second;
      most = std::max(most, l);
    });
  });
  const auto result = resample(map, r.source / 1000.0, r.target / 1000.0, 100'000);
  RC_ASSERT(result.has_value());
  RC_ASSERT(result->known_count() == expected.size());
  for (const auto& [voxel, l] : expected) RC_ASSERT(result->at(voxel) == l);
}

RC_GTEST_PROP(Resample, ToAFinerLatticeLooksUpTheCentre, ()) {
  const Ratio r = *rc::gen::suchThat(arbitrary_ratio(), [](Ratio x) { return x.source > x.target; });
  const BrickMap map = *arbitrary_map(2);
  const auto result = resample(map, r.source / 1000.0, r.target / 1000.0, 100'000);
  RC_ASSERT(result.has_value());
  // Every voxel that can look up one of the map's, which reaches 2 bricks to either side.
  const int reach = 2 * 8 * r.source / r.target + 2;
  std::size_t known = 0;
  for (int z = -reach; z < reach; ++z) {
    for (int y = -reach; y < reach; ++y) {
      for (int x = -reach; x < reach; ++x) {
        const LogOdds expected = map.at(holding({x, y, z}, r.target, r.source));
        RC_ASSERT(result->at({x, y, z}) == expected);
        known += is_known(expected);
      }
    }
  }
  RC_ASSERT(result->known_count() == known);
}

TEST(Resample, RefusesTooManyBricksAndVoxelsOutOfBounds) {
  BrickMap map;
  map.set({0, 0, 0}, Brick::uniform({1}, kFree));
  EXPECT_EQ(resample(map, 1.0, 0.01, 1000).error().code, Code::kTooLarge);
  EXPECT_EQ(resample(map, 100.0, 0.0001, 1000).error().code, Code::kOutOfBounds);
}

TEST(Resample, SixDigitsAreTheSameResolution) {
  EXPECT_TRUE(same_resolution(0.1 / 3, 0.0333333));
  EXPECT_FALSE(same_resolution(0.05, 0.0501));
}

}  // namespace
}  // namespace concord
