#include "planner/lattice/distance_field.hpp"

#include <gtest/gtest.h>

#include "lattice.hpp"

namespace concord {
namespace {

using test::Plain;

int nearest_blocked(const Plain& plain, int x, int y, int reach) {
  int least = reach * reach;
  for (int j = y - reach; j <= y + reach; ++j) {
    for (int i = x - reach; i <= x + reach; ++i) {
      if (!plain.at(i, j)) least = std::min(least, (i - x) * (i - x) + (j - y) * (j - y));
    }
  }
  return least;
}

TEST(DistanceField, IsExact) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    std::mt19937 random(seed);
    const Plain plain = test::random_plain(random, 40);
    const OpenGrid grid = test::to_grid(plain);
    const int reach = 1 + static_cast<int>(random() % 15);
    const DistanceField field(grid, reach);
    for (int y = 0; y < plain.height; ++y) {
      for (int x = 0; x < plain.width; ++x) {
        ASSERT_EQ(int{field.squared({x, y})}, nearest_blocked(plain, x, y, reach)) << seed << ": " << x << ' ' << y;
      }
    }
  }
}

TEST(DistanceField, AfterAChangeIsAsIfWorkedOutAnew) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    Plain plain = test::random_plain(random, seed % 5 == 0 ? 200 : 50);
    OpenGrid grid = test::to_grid(plain);
    const int reach = seed % 7 == 0 ? DistanceField::kMaxReach : 1 + static_cast<int>(random() % 20);
    DistanceField field(grid, reach);
    for (int change = 0; change < 10; ++change) {
      field.update(test::random_change(random, plain, grid));
      const DistanceField fresh(grid, reach);
      for (int y = 0; y < plain.height; ++y) {
        for (int x = 0; x < plain.width; ++x) ASSERT_EQ(field.squared({x, y}), fresh.squared({x, y})) << seed;
      }
    }
  }
}

TEST(DistanceField, ReachesAsFarAsItCan) {
  OpenGrid grid(600, 600);
  for (int y = 0; y < 600; ++y)
    for (int x = 0; x < 600; ++x) grid.set({x, y}, true);
  const DistanceField field(grid, DistanceField::kMaxReach);
  EXPECT_EQ(field.squared({300, 300}), 255 * 255);
  EXPECT_EQ(field.squared({0, 300}), 1);
  EXPECT_EQ(field.squared({99, 300}), 100 * 100);
}

}  // namespace
}  // namespace concord
