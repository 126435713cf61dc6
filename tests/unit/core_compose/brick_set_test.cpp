#include "core/brick_set.hpp"

#include <set>

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace concord {
namespace {

TEST(BrickSet, HoldsTheBricksOfItsBoxes) {
  EXPECT_TRUE(rc::check([] {
    BrickSet set;
    std::set<BrickIndex> expected;
    for (int box = 0; box < 3; ++box) {
      const auto low = [] { return *rc::gen::inRange(-9, 9); };
      const BrickIndex a{low(), low(), low()};
      const auto size = [] { return *rc::gen::inRange(0, 7); };
      const BrickIndex b{a.x + size(), a.y + size(), a.z + size()};
      set.insert_box(a, b);
      for (int z = a.z; z <= b.z; ++z) {
        for (int y = a.y; y <= b.y; ++y) {
          for (int x = a.x; x <= b.x; ++x) expected.insert({x, y, z});
        }
      }
    }
    RC_ASSERT(set.size() == expected.size());
    for (const BrickIndex brick : expected) RC_ASSERT(set.contains(brick));
    const auto entries = set.sorted();
    for (std::size_t i = 1; i < entries.size(); ++i) RC_ASSERT(entries[i - 1].tile < entries[i].tile);
  }));
}

TEST(BrickSet, TakesBricksAndOtherSets) {
  BrickSet a;
  EXPECT_TRUE(a.empty());
  a.insert(BrickIndex{-1, 2, 3});
  BrickSet b;
  b.insert(a);
  b.insert(BrickIndex{7, 7, 7});
  EXPECT_TRUE(b.contains({-1, 2, 3}));
  EXPECT_FALSE(a.contains({7, 7, 7}));
  EXPECT_EQ(b.size(), 2U);
  b.clear();
  EXPECT_TRUE(b.empty());
}

}  // namespace
}  // namespace concord
