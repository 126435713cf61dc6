#include "random_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace concord {

double any_number(double low, double high) {
  const bool is_round = *rc::gen::arbitrary<bool>();
  const int steps = is_round ? 8 : 1'000'003;
  return low + (high - low) * *rc::gen::inRange(0, steps + 1) / steps;
}

Eigen::Vector3d any_point(double reach) {
  const double x = any_number(-reach, reach), y = any_number(-reach, reach), z = any_number(-reach, reach);
  return {x, y, z};
}

Eigen::Matrix3d any_right_turn() {
  const int yaw = *rc::gen::inRange(0, 4), face = *rc::gen::inRange(0, 6);
  const auto turn = [](int quarters, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(quarters * std::numbers::pi / 2, axis).toRotationMatrix();
  };
  const Eigen::Matrix3d tilt =
      face < 4 ? turn(face, Eigen::Vector3d::UnitY()) : turn(2 * face - 9, Eigen::Vector3d::UnitX());
  return tilt * turn(yaw, Eigen::Vector3d::UnitZ());
}

Transform any_transform(double reach) {
  Transform T = Transform::Identity();
  if (*rc::gen::inRange(0, 4) == 0) {
    T.linear() = any_right_turn();
  } else {
    const Eigen::Vector3d axis = any_point(1) + Eigen::Vector3d(1e-3, 2e-3, 3e-3);
    T.linear() = Eigen::AngleAxisd(any_number(-3, 3), axis.normalized()).toRotationMatrix();
  }
  T.translation() = any_point(reach);
  return T;
}

std::vector<Eigen::Vector2d> any_polygon(double reach) {
  const int corners = *rc::gen::inRange(3, 12);
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < corners; ++i) {
    // A star around the origin: corners in the order of their angle, each in a sector of its own under half a turn.
    const double angle = 2 * std::numbers::pi * (i + any_number(0, 0.4)) / corners;
    const double radius = any_number(0.15, 1) * reach;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  if (*rc::gen::arbitrary<bool>()) std::reverse(points.begin(), points.end());
  return points;
}

std::vector<Eigen::Vector2d> comb(int teeth, double height) {
  std::vector<Eigen::Vector2d> points{{2.0 * teeth - 1, 0}, {2.0 * teeth - 1, 1 + height}};
  for (int i = teeth - 1; i > 0; --i) {
    points.insert(points.end(), {{2.0 * i, 1 + height}, {2.0 * i, 1}, {2.0 * i - 1, 1}, {2.0 * i - 1, 1 + height}});
  }
  points.insert(points.end(), {{0, 1 + height}, {0, 0}});
  return points;
}

std::vector<Eigen::Vector2d> spiral(int corners) {
  std::vector<Eigen::Vector2d> outer{{0, 0}}, inner{{0, 1}};
  const std::array<Eigen::Vector2d, 4> ways{Eigen::Vector2d{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  Eigen::Vector2d at(0, 0);
  for (int i = 0; i < corners; ++i) {
    const Eigen::Vector2d way = ways[static_cast<std::size_t>(i % 4)];
    const Eigen::Vector2d next = ways[static_cast<std::size_t>((i + 1) % 4)];
    at += way * (2.0 * ((corners - i + 1) / 2) + 1);
    outer.push_back(at);
    inner.push_back(at - way + next);
  }
  outer.insert(outer.end(), inner.rbegin(), inner.rend());
  return outer;
}

}  // namespace concord
