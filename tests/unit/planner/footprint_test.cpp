#include "planner/footprint/footprint.hpp"

#include <gtest/gtest.h>

#include "footprints.hpp"
#include "planner/footprint/footprint_text.hpp"
#include "planner/footprint/standing_room.hpp"

namespace concord {
namespace {

using Points = std::vector<Eigen::Vector2d>;

Code refusal(Points polygon) {
  const auto footprint = Footprint::make(std::move(polygon));
  EXPECT_FALSE(footprint.has_value());
  return footprint ? Code::kExists : footprint.error().code;
}

TEST(Footprint, KnowsItsDiscs) {
  const Footprint rectangle = *make_rectangle(1.2, 0.8);
  EXPECT_DOUBLE_EQ(rectangle.inscribed(), 0.4);
  EXPECT_DOUBLE_EQ(rectangle.circumscribed(), std::hypot(0.6, 0.4));
  EXPECT_EQ(rectangle.parts().size(), 1U);
  const Footprint in_cells = rectangle.scaled(20);
  EXPECT_DOUBLE_EQ(in_cells.inscribed(), 8);
  EXPECT_DOUBLE_EQ(in_cells.polygon()[2].x(), 12);
  EXPECT_DOUBLE_EQ(in_cells.parts()[0][2].x(), 12);
  // An axle at the back; clockwise comes out counter-clockwise.
  const Footprint car = *Footprint::make({{-0.2, 0.3}, {1, 0.3}, {1, -0.3}, {-0.2, -0.3}});
  EXPECT_DOUBLE_EQ(car.inscribed(), 0.2);
  EXPECT_GT(test::area(car.polygon()), 0);
}

TEST(Footprint, RefusesWhatIsNoOutline) {
  EXPECT_EQ(refusal({}), Code::kMalformed);
  EXPECT_EQ(refusal({{0, 0}, {1, 0}}), Code::kMalformed);
  EXPECT_EQ(refusal(Points(65, {1, 1})), Code::kTooLarge);
  EXPECT_EQ(refusal({{-1, -1}, {NAN, -1}, {0, 1}}), Code::kNotFinite);
  EXPECT_EQ(refusal({{-1, -1}, {INFINITY, -1}, {0, 1}}), Code::kNotFinite);
  EXPECT_EQ(refusal({{-1, -1}, {11, -1}, {0, 1}}), Code::kOutOfBounds);
  EXPECT_EQ(refusal({{-1, -1}, {1, 1}, {1, -1}, {-1, 1}}), Code::kBadShape);             // crosses itself
  EXPECT_EQ(refusal({{-1, -1}, {1, -1}, {1, 1}, {0, -1}, {-1, 1}}), Code::kBadShape);    // touches itself
  EXPECT_EQ(refusal({{-1, -1}, {1, -1}, {1, -1}, {0, 1}}), Code::kBadShape);             // a corner twice
  EXPECT_EQ(refusal({{-1, -1}, {1, -1}, {2, -1}, {1.5, -1}, {0, 1}}), Code::kBadShape);  // a spike
  EXPECT_EQ(refusal({{-1, 0}, {0, 0}, {1, 0}}), Code::kBadShape);                        // nothing in it
  EXPECT_EQ(refusal({{1, 1}, {2, 1}, {1.5, 2}}), Code::kBadShape);                       // not around the origin
  EXPECT_EQ(refusal({{0, -1}, {1, 0}, {0, 1}}), Code::kBadShape);                        // the origin on its edge
  EXPECT_EQ(refusal({{-1, -1}, {1, -1}, {1, 1}, {0.1, 1}, {0, -0.5}, {-0.1, 1}, {-1, 1}}), Code::kBadShape);
}

TEST(Footprint, ItsPartsMakeItUp) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    const Footprint footprint = test::random_footprint(random, 0.3, 2);
    double sum = 0;
    for (const Points& part : footprint.parts()) {
      sum += test::area(part);
      for (const Eigen::Vector2d& p : part) {
        EXPECT_NE(std::find(footprint.polygon().begin(), footprint.polygon().end(), p), footprint.polygon().end());
      }
    }
    EXPECT_NEAR(sum, test::area(footprint.polygon()), 1e-9) << seed;
  }
}

TEST(FootprintText, IsARectangleOrCorners) {
  EXPECT_DOUBLE_EQ(read_footprint("1.2x0.8")->polygon()[2].x(), 0.6);
  EXPECT_DOUBLE_EQ(read_footprint(" 1.2 x 0.8 ")->polygon()[2].y(), 0.4);
  EXPECT_EQ(read_footprint("-1 -1, 2 -1, +2 1, -1e0 1")->polygon()[2], Eigen::Vector2d(2, 1));
  for (const char* bad :
       {"", "x", "1.2", "1.2x", "1.2x0.8x1", "1.2y0.8", "1 1, 2", "1 1 1, 2 2, 3 3", "-1 -1, 2 -1,", "0 1,0 2,zero 1",
        "+-1x1", "1.2 0.8", "0x10", "-1x2", "infx1", "nan nan, 1 1, 2 2", "1e999x1", "100x100"}) {
    EXPECT_FALSE(read_footprint(bad).has_value()) << bad;
  }
  EXPECT_EQ(read_footprint(std::string(10'000, ' ')).error().code, Code::kTooLarge);
  EXPECT_EQ(read_footprint("nanx1").error().code, Code::kNotFinite);
}

TEST(PoseText, IsTwoOrThreeNumbers) {
  EXPECT_EQ(read_pose("1 -2.5 0.5")->p, Eigen::Vector2d(1, -2.5));
  EXPECT_EQ(read_pose("1, -2.5, 0.5")->yaw, 0.5);
  EXPECT_EQ(read_pose("1 2")->yaw, 0);
  for (const char* bad : {"", "1", "1 2 3 4", "a b c", "1 2 x", "1;2;3"})
    EXPECT_EQ(read_pose(bad).error().code, Code::kMalformed) << bad;
  for (const char* bad : {"nan 1 2", "1 inf 2", "1 2 1e999"})
    EXPECT_EQ(read_pose(bad).error().code, Code::kNotFinite) << bad;
}

/// A random map and footprint, in cells.
struct Place {
  explicit Place(unsigned seed)
      : random(seed),
        plain(test::random_plain(random, 40)),
        grid(test::to_grid(plain)),
        field(grid, 20),
        room(grid, field, test::random_footprint(random, 0.4, 5)) {}

  Pose any_pose() {
    Pose pose{{test::uniform(random, -1, plain.width + 1), test::uniform(random, -1, plain.height + 1)},
              test::uniform(random, -4, 4)};
    // Often where edges come to lie on the borders of cells.
    if (random() % 4 == 0) pose.p = {std::round(pose.p.x()), std::round(pose.p.y())};
    if (random() % 4 == 0) pose.yaw = std::round(pose.yaw) * M_PI / 2;
    return pose;
  }

  std::mt19937 random;
  test::Plain plain;
  OpenGrid grid;
  DistanceField field;
  StandingRoom room;
};

TEST(StandingRoom, IsWhereTheWholeAreaIsOverOpenCells) {
  int free = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    Place place(seed);
    for (int i = 0; i < 60; ++i) {
      const Pose pose = place.any_pose();
      const double overlap = test::worst_overlap(place.plain, place.room.footprint().polygon(), pose);
      const bool stands = place.room.stands(pose);
      free += stands;
      ASSERT_TRUE(stands ? overlap < 1e-4 : overlap > 0) << seed << ": " << pose.p.transpose() << ", " << pose.yaw;
    }
  }
  EXPECT_GT(free, 800);
}

TEST(StandingRoom, MayTouchButNotOverlap) {
  test::Plain plain = test::all_open(10, 4);
  plain.set(5, 0, false);
  const OpenGrid grid = test::to_grid(plain);
  const DistanceField field(grid, 10);
  const StandingRoom room(grid, field, *make_rectangle(3, 1));
  EXPECT_TRUE(room.stands({{3.5, 0.5}, 0}));
  EXPECT_TRUE(room.stands({{1.5, 0.5}, 0}));
  EXPECT_FALSE(room.stands({{3.501, 0.5}, 0}));
  EXPECT_TRUE(room.stands({{5.5, 1.5}, 0}));
  EXPECT_FALSE(room.stands({{5.5, 1.499}, 0}));
  EXPECT_TRUE(room.moves({{1.5, 1.5}, 0}, {7, 0}));
  EXPECT_FALSE(room.moves({{1.5, 0.5}, 0}, {2.01, 0}));
  EXPECT_FALSE(room.stands({{NAN, 1}, 0}));
  EXPECT_FALSE(room.stands({{1e300, 1}, 0}));
}

/// Along the arc, and as those see it who go straight from one pose to the next.
double worst_on_way(const Place& place, const std::vector<Eigen::Vector2d>& polygon, const Pose& start,
                    const Move& move) {
  constexpr int kSamples = 300;
  double worst = 0;
  const int steps = place.room.steps(move);
  for (int i = 0; i <= kSamples; ++i) {
    const double share = static_cast<double>(i) / kSamples;
    const int step = std::min(static_cast<int>(share * steps), steps - 1);
    const Pose a = move.from(start, static_cast<double>(step) / steps);
    const Pose b = move.from(start, (step + 1.0) / steps);
    worst = std::max({worst, test::worst_overlap(place.plain, polygon, move.from(start, share)),
                      test::worst_overlap(place.plain, polygon, test::between(a, b, share * steps - step))});
  }
  return worst;
}

TEST(StandingRoom, MovesCoverAllThatIsSwept) {
  int free = 0, blocked = 0;
  for (unsigned seed = 0; seed < 400; ++seed) {
    Place place(seed);
    for (int i = 0; i < 40; ++i) {
      const Pose pose = place.any_pose();
      if (!place.room.stands(pose)) continue;
      Move move{test::uniform(place.random, -12, 12), test::uniform(place.random, -3, 3)};
      if (i % 3 == 0) move.turn = 0;
      if (i % 3 == 1) move.travel = 0;
      const bool moves = place.room.moves(pose, move);
      ++(moves ? free : blocked);
      if (moves) {
        ASSERT_LT(worst_on_way(place, place.room.footprint().polygon(), pose, move), 1e-4) << seed;
        continue;
      }
      // It would not be free for one that is larger by twice the bow either.
      const double larger = 1 + 2 * 1.5 * StandingRoom::kBow / place.room.footprint().inscribed();
      ASSERT_GT(worst_on_way(place, place.room.footprint().scaled(larger).polygon(), pose, move), 0) << seed;
      break;
    }
  }
  EXPECT_GT(free, 50);
  EXPECT_GT(blocked, 50);
}

}  // namespace
}  // namespace concord
