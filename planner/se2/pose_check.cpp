#include "planner/se2/pose_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "planner/se2/outline.hpp"

namespace concord {
namespace {

/// Left for rounding, far below what any map knows, yet above what the search allows itself.
constexpr double kTouch = 2e-5;  ///< cells
constexpr double kSample = 0.125;
/// Of a yaw or of the direction of a step, radians. An arc's chord is its middle's direction exactly.
constexpr double kYaw = 1e-3;

std::string describe(const char* what, const Pose& pose) {
  char text[160];
  std::snprintf(text, sizeof(text), "%s at (%.3f, %.3f, %.3f)", what, pose.p.x(), pose.p.y(), pose.yaw);
  return text;
}

/// So much of the way from one pose to the next.
Pose between(const Pose& a, const Pose& b, double share) {
  return {a.p + share * (b.p - a.p), a.yaw + share * wrapped(b.yaw - a.yaw)};
}

/// In so many parts no point of the footprint moves more than `most` cells in one.
int parts(const PoseTerms& terms, const Pose& a, const Pose& b, double most) {
  const double moved =
      ((b.p - a.p).norm() + terms.footprint.circumscribed() * std::abs(wrapped(b.yaw - a.yaw))) / terms.resolution;
  return 1 + static_cast<int>(moved / most);
}

bool is_clear(const PoseTerms& terms, const Pose& pose) {
  const Eigen::Vector2d p = pose.p / terms.resolution;
  if (!(p.x() >= 0 && p.y() >= 0 && p.x() <= terms.grid.width() && p.y() <= terms.grid.height())) return false;
  bool clear = true;
  const Outline outline(terms.footprint.polygon(), pose, terms.resolution);
  outline.for_each_blocked(terms.grid, 0, [&](Cell cell) { return clear = !outline.overlaps(cell, kTouch); });
  return clear;
}

/// Whether a robot that steers so can go from one pose to the next.
bool is_drivable(const PoseTerms& terms, const Pose& a, const Pose& b) {
  const Eigen::Vector2d way = b.p - a.p;
  const double turn = wrapped(b.yaw - a.yaw);
  constexpr double kStill = 1e-6;  // metres
  if (way.norm() < kStill) return terms.turn_radius == 0 || std::abs(turn) < kYaw;
  if (terms.turn_radius == 0 && std::abs(turn) > kYaw) return false;
  // Short steps have directions that rounding may turn.
  const double along = std::atan2(way.y(), way.x()) - (a.yaw + turn / 2);
  if (std::abs(std::sin(along)) * way.norm() > kYaw * way.norm() + kStill) return false;
  return std::abs(turn) * terms.turn_radius <= way.norm() + terms.turn_radius * 1e-6 + kStill;
}

bool is_same(const Pose& a, const Pose& b) { return a.p == b.p && a.yaw == b.yaw; }

}  // namespace

std::optional<std::string> fault_of(const PoseTerms& terms, std::span<const Pose> poses) {
  if (poses.empty()) return "it has no pose";
  for (const Pose& pose : poses) {
    if (!pose.is_finite()) return "a pose is no number";
  }
  if (!is_same(poses.front(), terms.start)) return describe("it does not begin at the start, but", poses.front());
  if (!is_same(poses.back(), terms.goal)) return describe("it does not end at the goal, but", poses.back());
  if (!is_clear(terms, poses.front())) return describe("the footprint overlaps something", poses.front());
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Pose& a = poses[i - 1];
    const Pose& b = poses[i];
    if (!is_drivable(terms, a, b)) return describe("the robot cannot steer so", a);
    const int count = parts(terms, a, b, kSample);
    for (int k = 1; k <= count; ++k) {
      const Pose pose = between(a, b, static_cast<double>(k) / count);
      if (!is_clear(terms, pose)) return describe("the footprint overlaps something", pose);
    }
  }
  return std::nullopt;
}

PoseClearance clearance_of(const PoseTerms& terms, std::span<const Pose> poses, double reach) {
  const double most = reach / terms.resolution;
  const auto nearest = [&](const Pose& pose, double within) {
    const Outline outline(terms.footprint.polygon(), pose, terms.resolution);
    double least = within;
    outline.for_each_blocked(terms.grid, within, [&](Cell cell) {
      least = std::min(least, outline.distance(cell));
      return true;
    });
    return least;
  };
  PoseClearance clearance;
  double least = most, last = most;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Pose& a = poses[i > 0 ? i - 1 : 0];
    const int count = i > 0 ? parts(terms, a, poses[i], 1) : 0;
    for (int k = 1; k < count; ++k) least = nearest(between(a, poses[i], static_cast<double>(k) / count), least);
    // No point has come further from anything than it has moved.
    last = nearest(poses[i], std::min(most, last + count));
    least = std::min(least, last);
    clearance.at.push_back(last * terms.resolution);
  }
  clearance.least = least * terms.resolution;
  return clearance;
}

}  // namespace concord
