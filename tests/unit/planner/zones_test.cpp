// Paths and zones: planner/README.md states the rule.
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "planner/clearance.hpp"
#include "planner/free_space.hpp"
#include "planner/plan.hpp"
#include "planner/planner.hpp"
#include "sketch.hpp"
#include "zones.hpp"

namespace concord {
namespace {

using Rows = std::vector<std::string>;
using test::contact;
using test::no_go;

const Band kBand = make_band(0, 1, 1.0).value();

ZoneLayer layer_of(const std::vector<Zone>& zones) {
  ZoneLayer layer(1.0, kBand);
  layer.set(zones);
  return layer;
}

const Rows kHall(20, std::string(30, '.'));

TEST(PlanWithZones, GoesRoundANoGoZoneAtItsRadius) {
  const Grid grid = test::sketch(kHall);
  const ZoneLayer zones = layer_of({no_go("press", {12.2, 4.2}, {15.8, 12.8})});
  const PlanResult round = plan({grid, zones}, {4, 8}, {25, 8}, 1.3);
  ASSERT_EQ(round.reason, Reason::kOk) << round.message;
  EXPECT_GT(round.length, 22);
  EXPECT_GE(round.least_clearance, 1.3 - 1e-5);
  EXPECT_LT(round.least_clearance, 3);
  EXPECT_TRUE(is_clear({grid, zones}, round.points, 1.3));
  EXPECT_FALSE(is_clear({grid, zones}, std::vector<Eigen::Vector2d>{{4, 8}, {25, 8}}, 1.3));
  EXPECT_TRUE(is_clear(grid, std::vector<Eigen::Vector2d>{{4, 8}, {25, 8}}, 1.3));
}

TEST(PlanWithZones, SaysWhichZoneIsInTheWay) {
  const Grid grid = test::sketch(kHall);
  const ZoneLayer zones = layer_of({no_go("press", {12.2, -5}, {15.8, 40}), no_go("aisle", {100, 100}, {110, 110})});
  PlanResult result = plan({grid, zones}, {4, 8}, {13, 8}, 0.5);
  EXPECT_EQ(result.reason, Reason::kGoalInNoGo);
  EXPECT_NE(result.message.find("'press'"), std::string::npos) << result.message;
  result = plan({grid, zones}, {13, 8}, {4, 8}, 0.5);
  EXPECT_EQ(result.reason, Reason::kOk) << "a robot that stands in a zone may leave it";
  EXPECT_TRUE(result.message.starts_with("it leaves the no-go zone 'press' first")) << result.message;
  result = plan({grid, zones}, {4, 8}, {11.8, 8}, 0.5);
  EXPECT_EQ(result.reason, Reason::kGoalClearance);
  EXPECT_NE(result.message.find("'press'"), std::string::npos) << result.message;
  result = plan({grid, zones}, {4, 8}, {25, 8}, 0.5);
  EXPECT_EQ(result.reason, Reason::kNoValidPath);
  EXPECT_NE(result.message.find("'press'"), std::string::npos) << result.message;
  // A wall beside the zone: it is not the zone alone.
  Rows walled = kHall;
  for (std::string& row : walled) row[20] = '#';
  result = plan({test::sketch(walled), zones}, {4, 8}, {25, 8}, 0.5);
  EXPECT_EQ(result.reason, Reason::kNoValidPath);
  EXPECT_EQ(result.message.find("zone"), std::string::npos) << result.message;
  // Nor has a zone that the search never came near anything to do with it.
  result = plan({test::sketch(walled), layer_of({no_go("aisle", {100, 100}, {110, 110})})}, {4, 8}, {25, 8}, 0.5);
  EXPECT_EQ(result.message.find("zone"), std::string::npos) << result.message;
}

const Rows kDoor{
    "###############",  //
    "#......#......#",  //
    "#......#......#",  //
    "#.............#",  //
    "#......#......#",  //
    "#......#......#",  //
    "###############",
};

TEST(PlanWithZones, ContactLetsTheBodyOverNotTheCentre) {
  const Grid grid = test::sketch(kDoor);
  const Eigen::Vector2d left(3.5, 3.5);
  const Eigen::Vector2d right(11.5, 3.5);
  EXPECT_EQ(plan(grid, left, right, 0.8).reason, Reason::kNoValidPath);
  const ZoneLayer posts = layer_of({contact("posts", {7.1, 2.1}, {7.9, 4.9})});
  const PlanResult through = plan({grid, posts}, left, right, 0.8);
  ASSERT_EQ(through.reason, Reason::kOk) << through.message;
  EXPECT_NEAR(through.length, 8, 1e-9);
  EXPECT_NEAR(through.least_clearance, 0.5, 1e-9);  // said as it is
  // Contact with one post is not contact with the other.
  EXPECT_EQ(plan({grid, layer_of({contact("post", {7.1, 2.1}, {7.9, 2.9})})}, left, right, 0.8).reason,
            Reason::kNoValidPath);
  // What is occupied or unknown stays so.
  for (const char c : {'#', ' '}) {
    Rows shut = kDoor;
    shut[3][7] = c;
    EXPECT_EQ(plan({test::sketch(shut), posts}, left, right, 0.0).reason,
              c == '#' ? Reason::kNoValidPath : Reason::kBlockedByUnknown);
    EXPECT_EQ(plan({test::sketch(shut), posts}, left, {7.5, 3.5}, 0.0).reason,
              c == '#' ? Reason::kGoalOccupied : Reason::kGoalUnknown);
  }
  // No-go outranks it.
  const ZoneLayer outranked =
      layer_of({contact("posts", {7.1, 2.1}, {7.9, 4.9}), no_go("post", {7.1, 2.1}, {7.9, 2.9})});
  EXPECT_EQ(plan({grid, outranked}, left, right, 0.8).reason, Reason::kNoValidPath);
  const ZoneLayer both = layer_of({contact("all", {0, 0}, {15, 7}), no_go("door", {7.1, 3.1}, {7.9, 3.9})});
  EXPECT_EQ(plan({grid, both}, left, right, 0.0).reason, Reason::kNoValidPath);
  EXPECT_EQ(plan({grid, both}, left, {7.5, 3.5}, 0.0).reason, Reason::kGoalInNoGo);
  EXPECT_EQ(plan({grid, both}, left, {6.7, 3.5}, 0.8).reason, Reason::kGoalClearance);  // never relaxed
  EXPECT_EQ(plan({grid, both}, left, {1.2, 3.5}, 0.8).reason, Reason::kOk);             // against the wall
  EXPECT_EQ(plan({grid, both}, left, {1.0, 3.5}, 0.8).reason, Reason::kGoalClearance);  // not on its face
}

/// What the rule says of a robot at `p`, found cell by cell with nothing of the planner's. All in cells.
struct Oracle {
  const Grid& grid;
  std::set<Cell> no_go, contact;

  Oracle(const Grid& on, const std::vector<Zone>& zones) : grid(on) {
    for (const Zone& zone : zones) {
      const auto cells = footprint(zone.volume, zone.T_map_zone, 1.0, 0, 1, 1'000'000).value();
      for (const VoxelIndex cell : cells) (zone.kind == Zone::Kind::kNoGo ? no_go : contact).insert({cell.x, cell.y});
    }
  }
  [[nodiscard]] bool is_passable(Cell c) const { return is_free(grid.at(c)) && !no_go.contains(c); }
  /// How much room is missing for a disc of `radius` at `p`; below 0: none.
  [[nodiscard]] double lacks(double x, double y, double radius) const {
    double worst = -1;
    const auto r = static_cast<int>(std::ceil(radius)) + 1;
    const auto cx = static_cast<std::int32_t>(std::floor(x));
    const auto cy = static_cast<std::int32_t>(std::floor(y));
    for (std::int32_t j = cy - r; j <= cy + r; ++j) {
      for (std::int32_t i = cx - r; i <= cx + r; ++i) {
        if (is_passable({i, j})) continue;
        const double distance = test::distance(x, y, {i, j});
        const bool may_touch = contact.contains({i, j}) && !no_go.contains({i, j});
        worst = std::max(worst, distance == 0 ? 1.0 : may_touch ? -1.0 : radius - distance);
      }
    }
    return worst;
  }
};

std::vector<Zone> random_zones(std::mt19937& random, int most) {
  std::vector<Zone> zones;
  const auto count = static_cast<int>(random() % static_cast<unsigned>(most + 1));
  for (int i = 0; i < count; ++i) zones.push_back(test::random_zone(random, "z" + std::to_string(i), 40, 30, 6));
  return zones;
}

TEST(PlanWithZones, OpenCellsAreTheRuleCellByCell) {
  int open = 0;
  int by_contact = 0;
  for (unsigned seed = 0; seed < 120; ++seed) {
    std::mt19937 random(seed);
    const Grid grid = test::sketch(test::strewn(random, 40, 30, 0.03, 0.01));
    const double radius = seed % 4 == 0 ? 0.0 : 0.01 * static_cast<double>(random() % 400);
    const std::vector<Zone> zones = random_zones(random, 8);
    const ZoneLayer layer = layer_of(zones);
    const Oracle oracle(grid, zones);
    FreeSpace space({grid, layer}, radius);
    FreeSpace without(grid, radius);
    for (std::int32_t y = -2; y < 32; ++y) {
      for (std::int32_t x = -2; x < 42; ++x) {
        const bool is_open = oracle.lacks(x + 0.5, y + 0.5, radius) <= 0;
        ASSERT_EQ(space.is_open({x, y}), is_open) << "seed " << seed << " r " << radius << " cell " << x << " " << y;
        open += is_open ? 1 : 0;
        by_contact += is_open && !without.is_open({x, y}) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(open, 10'000);
  EXPECT_GT(by_contact, 300);
}

TEST(PlanWithZones, LinesOfSightAreTheValidators) {
  int seen = 0;
  int by_contact = 0;
  for (unsigned seed = 0; seed < 150; ++seed) {
    std::mt19937 random(seed);
    const Grid grid = test::sketch(test::strewn(random, 40, 30, 0.01, 0.003));
    const double radius = seed % 3 == 0 ? 0.0 : 0.25 * static_cast<double>(random() % 8);
    const ZoneLayer layer = layer_of(random_zones(random, 6));
    FreeSpace space({grid, layer}, radius);
    const auto point = [&] {
      return Eigen::Vector2d(0.5 * static_cast<double>(random() % 80), 0.5 * static_cast<double>(random() % 60));
    };
    for (int i = 0; i < 60; ++i) {
      const std::array<Eigen::Vector2d, 2> line{point(), point()};
      const bool clear = is_clear({grid, layer}, line, radius);
      ASSERT_EQ(space.sees(line[0], line[1]), clear)
          << "seed " << seed << " r " << radius << " " << line[0].transpose() << " to " << line[1].transpose();
      seen += clear ? 1 : 0;
      by_contact += clear && !is_clear(grid, line, radius) ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 400);
  EXPECT_GT(by_contact, 10);
}

bool leaves_a_zone(const std::string& message) { return message.starts_with("it leaves the no-go zone"); }

/// Every twentieth of a cell along the path.
void expect_respected(const Oracle& oracle, const std::vector<Eigen::Vector2d>& points, double radius) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Eigen::Vector2d step = points[i] - points[i - 1];
    const int samples = static_cast<int>(step.norm() * 20) + 1;
    for (int k = 0; k <= samples; ++k) {
      const Eigen::Vector2d p = points[i - 1] + step * k / samples;
      ASSERT_LE(oracle.lacks(p.x(), p.y(), radius), 1e-5) << p.transpose();
    }
  }
}

TEST(PlanWithZones, EveryPathKeepsTheRule) {
  int found = 0;
  std::map<Reason, int> failed;
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    const Grid grid = test::sketch(test::strewn(random, 40, 30, 0.001 * static_cast<double>(random() % 120), 0.01));
    const double radius = seed % 3 == 0 ? 0.0 : 0.01 * static_cast<double>(random() % 180);
    const std::vector<Zone> zones = random_zones(random, 8);
    const ZoneLayer layer = layer_of(zones);
    const Oracle oracle(grid, zones);
    const auto anywhere = [&] {
      return Eigen::Vector2d(0.01 * static_cast<double>(random() % 4000), 0.01 * static_cast<double>(random() % 3000));
    };
    for (int i = 0; i < 15; ++i) {
      const Eigen::Vector2d start = anywhere();
      const Eigen::Vector2d goal = anywhere();
      const PlanResult result = plan({grid, layer}, start, goal, radius);
      const PlanResult back = plan({grid, layer}, goal, start, radius);
      ASSERT_NE(result.reason, Reason::kValidationFailed) << "seed " << seed;
      if (leaves_a_zone(result.message) || leaves_a_zone(back.message)) continue;
      ASSERT_EQ(result.reason == Reason::kOk, back.reason == Reason::kOk) << "seed " << seed;
      ++failed[result.reason];
      if (result.message.find("without them there is a way") != std::string::npos) {
        std::vector<Zone> rest = zones;
        std::erase_if(rest, [](const Zone& zone) { return zone.kind == Zone::Kind::kNoGo; });
        ASSERT_EQ(plan({grid, layer_of(rest)}, start, goal, radius).reason, Reason::kOk) << "seed " << seed;
      }
      if (result.reason != Reason::kOk) continue;
      ++found;
      expect_respected(oracle, result.points, radius);
      if (HasFatalFailure()) FAIL() << "seed " << seed << " " << start.transpose() << " to " << goal.transpose();
    }
  }
  EXPECT_GT(found, 200);
  EXPECT_GT(failed[Reason::kGoalInNoGo], 50);
  EXPECT_GT(failed[Reason::kNoValidPath], 30);
  EXPECT_GT(failed[Reason::kBlockedByUnknown], 10);
}

class ZonesAndActivePaths : public testing::Test {
 protected:
  void show(const Rows& rows) {
    test::sketch(rows).cells().for_each_brick(
        [&](BrickIndex index, const Brick& brick) { planner_.set_brick(index, brick); });
    planner_.project();
  }
  Path ask(double radius = 0.8) {
    PathRequest request;
    request.id = "p" + std::to_string(++asked_);
    request.robot = "robot1";
    request.start = Eigen::Vector2d(4, 8);
    request.goal = {25, 8};
    request.keep_active = true;
    return planner_.request(request, {radius}, {1, utime_}).path.value();
  }
  std::vector<Path> set(const std::vector<Zone>& zones) {
    planner_.set_zones(zones);
    utime_ += 1'000'000;
    planner_.serve({1, utime_});
    return planner_.replan({1, utime_});
  }

  Planner planner_{Grid(1.0, kBand, 0.5)};
  int asked_ = 0;
  std::int64_t utime_ = 1'700'000'000'000'000;
};

TEST_F(ZonesAndActivePaths, NoPathBeforeTheZonesAreKnown) {
  show(kHall);
  EXPECT_EQ(ask().status, "NO_ZONES");
  EXPECT_TRUE(planner_.replan({1, utime_}).empty());
  const std::vector<Path> paths = set({});
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].status, "OK");
}

TEST_F(ZonesAndActivePaths, AZoneReplansThePathsItTouchesAndNoOther) {
  show(Rows(40, std::string(30, '.')));
  set({});
  const double length = ask().length;
  EXPECT_TRUE(set({no_go("aside", {10, 32}, {12, 35})}).empty());
  EXPECT_TRUE(set({no_go("aside", {0, 8}, {1, 9})}).empty());  // near, but not so near that it costs a tenth
  std::vector<Path> paths = set({no_go("aside", {10, 7}, {20, 18})});
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].status, "OK");
  EXPECT_EQ(paths[0].plan_number, 1);
  EXPECT_GT(paths[0].length, length);
  paths = set({no_go("all", {10, -5}, {12, 50})});
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].status, "NO_VALID_PATH");
  EXPECT_NE(paths[0].message.find("'all'"), std::string::npos) << paths[0].message;
  paths = set({});
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].status, "OK");
  EXPECT_NEAR(paths[0].length, length, 1e-9);
  paths = set({no_go("yard", {24, -1e6}, {1e6, 1e6})});  // not drawn cell by cell
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].status, "GOAL_IN_NO_GO");
  paths = set({no_go("yard", {26.5, -1e6}, {1e6, 1e6})});
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].status, "OK");
}

TEST_F(ZonesAndActivePaths, AZoneIsNotBlamedWhereAWallClosesTheWayToo) {
  show(kHall);
  set({no_go("all", {10, -5}, {12, 50}), no_go("aside", {16, -5}, {17, 50}), no_go("corner", {0, 0}, {1, 1})});
  const Path path = ask();
  EXPECT_EQ(path.status, "NO_VALID_PATH");
  EXPECT_NE(path.message.find("through 'all', 'aside'"), std::string::npos) << path.message;
  EXPECT_EQ(path.message.find("corner"), std::string::npos) << path.message;
  Rows walled = kHall;
  for (std::string& row : walled) row[20] = '#';
  show(walled);
  utime_ += 1'000'000;
  const std::vector<Path> paths = planner_.replan({1, utime_});
  ASSERT_EQ(paths.size(), 1U) << "the reason is another now";
  EXPECT_EQ(paths[0].status, "NO_VALID_PATH");
  EXPECT_EQ(paths[0].message.find("zone"), std::string::npos) << paths[0].message;
  EXPECT_EQ(ask().message, paths[0].message);
}

TEST(PlanWithZones, AnEndThatAWallClosesTooSaysSo) {
  Rows rows = kHall;
  rows[8][25] = '#';
  const Grid grid = test::sketch(rows);
  const Eigen::Vector2d start(4, 8);
  const auto message = [&](const Eigen::Vector2d& goal, const Zone& zone) {
    return plan({grid, layer_of({zone})}, start, goal, 0.8).message;
  };
  const Zone over = no_go("over", {25, 8}, {26, 9}), before = no_go("before", {23.9, 5}, {24.5, 12});
  EXPECT_NE(message({25.5, 8.5}, over).find("'over', and is occupied"), std::string::npos);
  EXPECT_EQ(message({20.5, 8.5}, no_go("n", {20, 8}, {21, 9})).find("occupied"), std::string::npos);
  // 24.5 is half a metre from the wall at 25 and in the zone's cells beside it; 22.5 is near the zone alone.
  EXPECT_NE(
      message({24.5, 9.5}, no_go("b", {23, 10.1}, {24, 12})).find("a wall or unobserved cell is too near as well"),
      std::string::npos);
  EXPECT_EQ(message({22.5, 9.5}, before).find("too near as well"), std::string::npos);
}

TEST_F(ZonesAndActivePaths, ContactThatEndsEndsThePathThatUsedIt) {
  Rows rows = kHall;
  for (int y = 0; y < 20; ++y) rows[y][14] = y == 8 ? '.' : '#';
  show(rows);
  const Zone door = contact("door", {14.1, 7.5}, {14.9, 9.5});
  set({door});
  EXPECT_EQ(ask().status, "OK");
  EXPECT_TRUE(set({door, no_go("aside", {10, 15}, {12, 18})}).empty());
  std::vector<Path> paths = set({});
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].status, "NO_VALID_PATH");
  paths = set({door});
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].status, "OK");
}

TEST_F(ZonesAndActivePaths, TheAnswerIsNeverWrongWhileZonesComeAndGo) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    Rows rows = test::strewn(random, 40, 30, 0.08, 0.01);
    rows[8][4] = rows[8][25] = '.';
    show(rows);
    std::vector<Zone> zones;
    set(zones);
    Path path = ask(0.4);
    for (int change = 0; change < 30; ++change) {
      if (random() % 2 == 0 && !zones.empty()) {
        zones.erase(zones.begin() + static_cast<std::ptrdiff_t>(random() % zones.size()));
      } else {
        zones.push_back(test::random_zone(random, "z" + std::to_string(random()), 40, 30, 5));
      }
      for (const Path& next : set(zones)) path = next;
      const Grid& grid = planner_.grid();
      const PlanResult fresh = plan({grid, layer_of(zones)}, {4, 8}, {25, 8}, 0.4);
      ASSERT_EQ(path.status == "OK", fresh.reason == Reason::kOk) << "seed " << seed << " change " << change;
      if (path.status != "OK" || leaves_a_zone(path.message)) continue;
      std::vector<Eigen::Vector2d> points;
      for (const Eigen::Vector3d& p : path.points) points.push_back(p.head<2>());
      expect_respected(Oracle(grid, zones), points, 0.4);
      if (HasFatalFailure()) FAIL() << "seed " << seed << " change " << change;
    }
  }
}

}  // namespace
}  // namespace concord
