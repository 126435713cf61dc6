// Maps that once were taken for what they are not.

#include <gtest/gtest.h>

#include "rooms.hpp"

namespace concord::test {
namespace {

constexpr double kWallStep = 0.05;

void add_wall(Points& out, double x0, double y0, double x1, double y1, double low, double high) {
  const double length = std::hypot(x1 - x0, y1 - y0);
  for (double s = 0.0; s <= length; s += kWallStep) {
    for (double z = low; z <= high; z += kWallStep) {
      out.emplace_back(Eigen::Vector3d(x0 + (x1 - x0) * s / length, y0 + (y1 - y0) * s / length, z).cast<float>());
    }
  }
}

void add_level(Points& out, double x0, double y0, double x1, double y1, double z) {
  for (double x = x0; x <= x1; x += kWallStep) {
    for (double y = y0; y <= y1; y += kWallStep) out.emplace_back(Eigen::Vector3d(x, y, z).cast<float>());
  }
}

Points hall_with_partition(double x, double length) {
  Points out;
  add_wall(out, -10, -6, 10, -6, 0, 3);
  add_wall(out, -10, 6, 10, 6, 0, 3);
  add_wall(out, -10, -6, -10, 6, 0, 3);
  add_wall(out, 10, -6, 10, 6, 0, 3);
  add_level(out, -10, -6, 10, 6, 0);
  add_level(out, -10, -6, 10, 6, 3);
  add_wall(out, x, -5, x, -5 + length, 0, 2);
  return out;
}

TEST(NeverFooled, ByAHallTurnedRoundWhosePartitionWasMoved) {
  for (const double length : {4.0, 6.0, 7.0}) {
    const Transform T = transform(2.0, 1.0, 0.3, std::numbers::pi);
    const AlignMap target = cloud_map(hall_with_partition(-5, length));
    const AlignMap source = cloud_map(moved(hall_with_partition(3, length), T.inverse()));
    const Alignment answer = align(target, source, std::nullopt, 1);
    EXPECT_FALSE(answer.accepted() && degrees_off(answer.T_target_source, T) > 2.0) << length << " m";
  }
}

TEST(NeverFooled, ByATableThatLiesOnTheFloorForWantOfOne) {
  const auto walls = [](double low) {
    Points out;
    const double corners[][2] = {{-3, -2.2}, {3, -2.2}, {3, 1.2}, {1.8, 1.2}, {1.8, 2.3}, {-3, 2.3}, {-3, -2.2}};
    for (int i = 0; i < 6; ++i) {
      add_wall(out, corners[i][0], corners[i][1], corners[i + 1][0], corners[i + 1][1], low, 2.4);
    }
    return out;
  };
  Points with_floor = walls(0.0);
  add_level(with_floor, -3, -2.2, 3, 1.2, 0.0);
  const Transform T = transform(3.0, -1.0, 0.4, 0.7);
  for (const double table : {0.45, 0.75, 1.1}) {
    Points without = walls(0.6);
    add_level(without, -1, -0.6, 1.2, 0.8, table);
    const AlignMap target = cloud_map(with_floor);
    const AlignMap source = cloud_map(moved(without, T.inverse()));
    for (const std::optional<Transform>& guess : {std::optional<Transform>(), std::optional<Transform>(T)}) {
      const Alignment answer = align(target, source, guess, 1);
      EXPECT_FALSE(answer.accepted() && metres_off(answer.T_target_source, T) > 0.3) << table << " m";
    }
  }
}

TEST(NeverFooled, ByARoundRoomThatNothingHolds) {
  Points round;
  for (int i = 0; i < 360; ++i) {
    const double a = degrees(i);
    for (double z = 0.0; z <= 2.5; z += kWallStep) {
      round.emplace_back(Eigen::Vector3d(3 * std::cos(a), 3 * std::sin(a), z).cast<float>());
    }
  }
  add_level(round, -2, -2, 2, 2, 0.0);
  const AlignMap map = cloud_map(round);
  for (const double turn : {0.0, 4.5, 10.0}) {
    EXPECT_FALSE(recheck(map, map, transform(0, 0, 0, degrees(turn)), 1).accepted()) << turn << " degrees";
  }
}

/// Offices in a row along a corridor, all alike but for a chair.
Points offices(int first, int last) {
  Points out;
  for (int room = first; room <= last; ++room) {
    const double x = 4.0 * room;
    add_wall(out, x, 0, x, 5, 0, 2.6);
    add_wall(out, x + 4, 0, x + 4, 5, 0, 2.6);
    add_wall(out, x, 5, x + 4, 5, 0, 2.6);
    add_wall(out, x, 0, x + 1.5, 0, 0, 2.6);
    add_wall(out, x + 2.4, 0, x + 4, 0, 0, 2.6);
    add_level(out, x, -2, x + 4, 5, 0.0);
    add_level(out, x + 0.5, 3.5, x + 2.1, 4.3, 0.75);
    add_box(out, {x + 1.0 + 0.3 * (room % 3), 2.0, 0.0}, {x + 1.4 + 0.3 * (room % 3), 2.4, 0.9});
    add_wall(out, x, -2, x + 4, -2, 0, 2.6);
  }
  return out;
}

TEST(NeverFooled, ByTheNextOffice) {
  const AlignMap target = cloud_map(offices(0, 2));
  const Transform T = transform(1.0, 3.0, -0.4, 2.6);
  const AlignMap source = cloud_map(moved(offices(1, 3), T.inverse()));
  const Transform guesses[] = {T, transform(1.9, 0, 0, 0) * T, transform(-1.9, 0, 0, 0) * T,
                               T * transform(0.5, 0.5, 0.0, degrees(20)), T * transform(0, 0, 0, degrees(-40))};
  for (const Transform& guess : guesses) {
    const Alignment answer = align(target, source, guess, 1);
    EXPECT_FALSE(answer.accepted() && metres_off(answer.T_target_source, T) > 0.3) << answer.message;
  }
  const Alignment answer = align(target, source, std::nullopt, 1);
  EXPECT_FALSE(answer.accepted() && metres_off(answer.T_target_source, T) > 0.3) << answer.message;
}

TEST(Align, ATrueGuessIsTakenWhereRoomsRepeat) {
  const AlignMap target = cloud_map(offices(0, 2));
  const Transform T = transform(1.0, 3.0, -0.4, 2.6);
  const AlignMap source = cloud_map(moved(offices(1, 3), T.inverse()));
  const Alignment answer = align(target, source, transform(0.5, -0.4, 0.1, degrees(10)) * T, 1);
  EXPECT_TRUE(answer.accepted()) << answer.message;
  EXPECT_LT(metres_off(answer.T_target_source, T), 0.15);
}

TEST(Align, SaysWhereElseTheMapsFit) {
  Points twin;
  add_box(twin, {-3.0, -2.2, 0.0}, {3.0, 2.2, 2.6});
  const AlignMap map = cloud_map(twin);
  const Alignment answer = align(map, map, std::nullopt, 1);
  ASSERT_EQ(answer.reason, AlignReason::kAmbiguous) << answer.message;
  ASSERT_FALSE(answer.T_target_source_rivals.empty());
  EXPECT_GT(degrees_off(answer.T_target_source_rivals.front(), answer.T_target_source), 90.0);
}

}  // namespace
}  // namespace concord::test
