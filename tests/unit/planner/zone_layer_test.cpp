#include "planner/zone_layer.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "sketch.hpp"
#include "zones.hpp"

namespace concord {
namespace {

const Band kBand = make_band(0, 2, 0.1).value();

/// The rule, zone by zone and cell by cell.
struct Said {
  std::set<Cell> no_go, contact;
};
Said said(const std::vector<Zone>& zones, double r, double zmin, double zmax) {
  Said all;
  for (const Zone& zone : zones) {
    const auto cells = footprint(zone.volume, zone.T_map_zone, r, zmin, zmax, 10'000'000);
    EXPECT_TRUE(cells);
    for (const VoxelIndex cell : *cells) {
      (zone.kind == Zone::Kind::kNoGo ? all.no_go : all.contact).insert({cell.x, cell.y});
    }
  }
  return all;
}

bool holds(std::uint64_t plane, Cell cell) { return (plane >> local_of(VoxelIndex{cell.x, cell.y, 0}) & 1) != 0; }
BrickIndex column_of(Cell cell) { return {cell.x >> 3, cell.y >> 3, 0}; }

/// 2 where its body keeps out, 1 where its centre does, 0 where it is as the grid says.
int restriction(const ZoneLayer& layer, Cell cell) {
  if (holds(layer.no_go(column_of(cell)), cell)) return 2;
  return holds(layer.contact(column_of(cell)), cell) ? 0 : 1;
}

TEST(ZoneLayer, IsTheRuleCellByCellHoweverZonesCameAndWent) {
  constexpr double r = 0.1;
  constexpr int kCells = 80;
  std::size_t covered = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    ZoneLayer layer(r, kBand);
    std::vector<Zone> zones;
    for (int step = 0; step < 25; ++step) {
      const std::vector<Zone> before = zones;
      const unsigned what = random() % 4;
      if (what == 0 && !zones.empty()) {
        zones.erase(zones.begin() + static_cast<std::ptrdiff_t>(random() % zones.size()));
      } else if (what == 1 && !zones.empty()) {
        Zone& changed = zones[random() % zones.size()];
        changed = test::random_zone(random, changed.name, 8, 8, 1.5);
      } else {
        zones.push_back(test::random_zone(random, "zone" + std::to_string(random() % 1000), 8, 8, 1.5));
      }
      std::vector<std::pair<Cell, int>> was;
      for (std::int32_t y = -20; y < kCells + 20; ++y) {
        for (std::int32_t x = -20; x < kCells + 20; ++x) was.emplace_back(Cell{x, y}, restriction(layer, {x, y}));
      }
      const ZoneLayer::Change change = layer.set(zones);
      EXPECT_FALSE(change.anywhere);
      ASSERT_TRUE(std::is_sorted(change.columns.begin(), change.columns.end(),
                                 [](const auto& a, const auto& b) { return a.column < b.column; }));
      const Said now = said(zones, r, 0, 2);
      std::map<BrickIndex, ColumnChange> expected;
      for (const auto& [cell, old] : was) {
        ASSERT_EQ(holds(layer.no_go(column_of(cell)), cell), now.no_go.contains(cell)) << seed << " " << step;
        ASSERT_EQ(holds(layer.contact(column_of(cell)), cell), now.contact.contains(cell)) << seed << " " << step;
        const std::string* name = layer.no_go_at(cell);
        ASSERT_EQ(name != nullptr, now.no_go.contains(cell));
        covered += now.no_go.contains(cell) ? 1 : 0;
        const int present = restriction(layer, cell);
        if (present == old) continue;
        ColumnChange& column = expected[column_of(cell)];
        (present > old ? column.blocked : column.freed) |= std::uint64_t{1} << local_of(VoxelIndex{cell.x, cell.y, 0});
      }
      // Exactly the cells whose rule is another.
      ASSERT_EQ(change.columns.size(), expected.size()) << seed << " " << step;
      for (const ColumnChange& column : change.columns) {
        ASSERT_EQ(column.blocked, expected[column.column].blocked);
        ASSERT_EQ(column.freed, expected[column.column].freed);
      }
      ASSERT_EQ(layer.size(), zones.size());
    }
  }
  EXPECT_GT(covered, 10'000U);
}

TEST(ZoneLayer, ThatIsSaidAgainIsNoChange) {
  ZoneLayer layer(0.1, kBand);
  std::vector<Zone> zones{test::no_go("b", {0, 0}, {1, 1}), test::contact("a", {0, 0}, {2, 1})};
  EXPECT_FALSE(layer.set(zones).columns.empty());
  std::swap(zones[0], zones[1]);
  zones[0].author = "someone";
  zones[0].revision = 7;
  EXPECT_TRUE(layer.set(zones).columns.empty());
  zones[1].name = "c";  // the same place by another name
  EXPECT_TRUE(layer.set(zones).columns.empty());
  ASSERT_NE(layer.no_go_at({3, 3}), nullptr);
  EXPECT_EQ(*layer.no_go_at({3, 3}), "c");
  // Two of one name do not come from merge; should they come, none is lost.
  zones.push_back(test::no_go("c", {5, 5}, {6, 6}));
  layer.set(zones);
  EXPECT_NE(layer.no_go_at({3, 3}), nullptr);
  EXPECT_NE(layer.no_go_at({55, 55}), nullptr);
}

TEST(ZoneLayer, HeedsWhatTheBandAndTheZoneHaveInCommonOnly) {
  ZoneLayer layer(0.1, kBand);
  const auto at_height = [&](double low, double high) {
    Zone zone = test::no_go("shelf", {0, 0}, {1, 1});
    zone.volume = Box{{0, 0, low}, {1, 1, high}};
    layer.set({&zone, 1});
    return layer.no_go_at({3, 3}) != nullptr;
  };
  EXPECT_FALSE(at_height(2.3, 3));
  EXPECT_TRUE(at_height(1.9, 3));
  EXPECT_TRUE(at_height(-1, 0.05));
  EXPECT_FALSE(at_height(-1, -0.2));
}

TEST(ZoneLayer, ANoGoZoneThatIsTooLargeIsTheRectangleAroundIt) {
  ZoneLayer layer(0.1, kBand);
  Prism triangle;
  triangle.points = {{-100, -100}, {900, -100}, {-100, 900}};
  triangle.low = 0;
  triangle.high = 1;
  Zone yard = test::no_go("yard", {0, 0}, {1, 1});
  yard.volume = triangle;
  Zone open = yard;
  open.name = "open";
  open.kind = Zone::Kind::kAllowContact;
  const std::vector<Zone> zones{yard, open, test::no_go("near", {-110, 0}, {-105, 1})};
  const ZoneLayer::Change change = layer.set(zones);
  EXPECT_TRUE(change.anywhere);
  EXPECT_EQ(layer.coarse(), (std::vector<std::string>{"open", "yard"}));
  EXPECT_EQ(*layer.no_go_at({0, 0}), "yard");
  EXPECT_EQ(*layer.no_go_at({8990, 8990}), "yard");  // on the safe side
  EXPECT_EQ(layer.no_go_at({9010, 0}), nullptr);
  EXPECT_EQ(*layer.no_go_at({-1080, 5}), "near");
  EXPECT_EQ(layer.contact({0, 0, 0}), 0U);
  EXPECT_EQ(layer.no_go({0, 0, 0}), ~std::uint64_t{0});
  EXPECT_FALSE(layer.set(zones).anywhere);
  EXPECT_TRUE(layer.set({}).anywhere);
  EXPECT_EQ(layer.no_go_at({0, 0}), nullptr);
}

TEST(ZoneLayer, NoGoZonesThatCannotBePlacedAreHeededAllTheSame) {
  const auto forbids = [](const Zone& zone, Cell cell) {
    ZoneLayer layer(0.1, kBand);
    layer.set({&zone, 1});
    return layer.no_go_at(cell) != nullptr;
  };
  Zone zone = test::no_go("z", {-1e7, -1e7}, {1e7, 1e7});  // beyond the lattice
  EXPECT_TRUE(forbids(zone, {0, 0}));
  EXPECT_TRUE(forbids(zone, {kMaxVoxel - 1, -kMaxVoxel}));
  zone = test::no_go("z", {1, 1}, {1e300, 2});
  EXPECT_TRUE(forbids(zone, {100, 15}));
  EXPECT_FALSE(forbids(zone, {0, 0}));
  zone = test::no_go("z", {NAN, 1}, {2, 2});
  EXPECT_TRUE(forbids(zone, {100, 15}));
  zone = test::no_go("z", {1, 1}, {2, 2});
  zone.T_map_zone.translation().x() = INFINITY;
  EXPECT_TRUE(forbids(zone, {100, 15}));
  Prism empty;
  zone.volume = empty;
  EXPECT_TRUE(forbids(zone, {100, 15}));
}

/// Which zones are drawn depends on the list, not on how it came about.
TEST(ZoneLayer, AllZonesTogetherAreBounded) {
  std::vector<Zone> zones;
  for (int i = 0; i < 20; ++i) {
    zones.push_back(test::no_go("zone" + std::to_string(10 + i), {100.0 * i, 0}, {100.0 * i + 95, 95}));
  }
  ZoneLayer all(0.1, kBand);
  all.set(zones);
  ASSERT_FALSE(all.coarse().empty());
  EXPECT_EQ(all.coarse().back(), "zone29");
  ZoneLayer one_by_one(0.1, kBand);
  for (std::size_t i = 0; i < zones.size(); ++i) one_by_one.set({&zones[zones.size() - 1 - i], i + 1});
  EXPECT_EQ(one_by_one.coarse(), all.coarse());
  for (std::int32_t x = -10; x < 20'000; x += 17) {
    EXPECT_EQ(one_by_one.no_go_at({x, 30}), nullptr == all.no_go_at({x, 30}) ? nullptr : one_by_one.no_go_at({x, 30}));
    EXPECT_EQ(one_by_one.no_go({x >> 3, 3, 0}), all.no_go({x >> 3, 3, 0})) << x;
  }
  const std::span<const Zone> fewer(zones.data() + 10, 10);  // there is room again
  EXPECT_TRUE(one_by_one.set(fewer).anywhere);
  EXPECT_TRUE(one_by_one.coarse().empty());
  EXPECT_NE(one_by_one.no_go_at({19'500, 30}), nullptr);
  EXPECT_EQ(one_by_one.no_go_at({30, 30}), nullptr);
}

/// A thousand is what a list may hold: drawing each to find out that there is no room takes half a minute.
TEST(ZoneLayer, ZonesForWhichThereIsNoRoomAreNotDrawn) {
  std::vector<Zone> zones;
  for (int i = 0; i < 1000; ++i) {
    zones.push_back(test::no_go("zone" + std::to_string(1000 + i), {0.05 * i, 0}, {0.05 * i + 95, 95}));
  }
  ZoneLayer layer(0.1, kBand);
  const auto begin = std::chrono::steady_clock::now();
  layer.set(zones);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
  EXPECT_GE(layer.coarse().size(), 980U);
  EXPECT_EQ(layer.coarse().back(), "zone1999");
}

/// Counting is drawing without the cells.
TEST(ZoneLayer, CountsWhatItDraws) {
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i) {
    const Zone zone = test::random_zone(random, "a", 8, 8, 3);
    const auto counted = count(zone, 0.1, kBand, 100'000);
    const auto drawn = draw(zone, 0.1, kBand, 100'000);
    ASSERT_TRUE(counted && drawn);
    EXPECT_EQ(*counted, drawn->count);
    if (*counted == 0) continue;
    EXPECT_FALSE(count(zone, 0.1, kBand, *counted - 1));
    EXPECT_TRUE(count(zone, 0.1, kBand, *counted));
  }
}

TEST(ZoneLayer, NamesTheNearestNoGoZone) {
  ZoneLayer layer(0.1, kBand);
  layer.set(std::vector{test::no_go("far", {2.05, 0}, {3, 1}), test::no_go("near", {-2, 0}, {-0.55, 1}),
                        test::contact("other", {0, 0}, {0.5, 1})});
  EXPECT_FALSE(layer.nearest_no_go({0, 5}, 4.9));
  const auto near = layer.nearest_no_go({0, 5}, 30);
  ASSERT_TRUE(near);
  EXPECT_EQ(near->name, "near");
  EXPECT_DOUBLE_EQ(near->distance, 5);
}

}  // namespace
}  // namespace concord
