#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Geometry>

#include "lattice.hpp"
#include "planner/footprint/footprint.hpp"
#include "planner/footprint/pose.hpp"

namespace concord::test {

inline double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
}

inline double area(const std::vector<Eigen::Vector2d>& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

/// A rectangle, or corners at random distances in random directions around the origin: as often as not with dents.
inline Footprint random_footprint(std::mt19937& random, double least, double most) {
  if (random() % 2 == 0) return *make_rectangle(uniform(random, 2 * least, 2 * most), uniform(random, 2 * least, most));
  while (true) {
    std::vector<double> directions;
    for (unsigned i = 0, n = 3 + random() % 6; i < n; ++i) directions.push_back(uniform(random, -M_PI, M_PI));
    std::sort(directions.begin(), directions.end());
    std::vector<Eigen::Vector2d> corners;
    for (const double d : directions)
      corners.push_back(uniform(random, least, most) * Eigen::Vector2d(std::cos(d), std::sin(d)));
    if (auto footprint = Footprint::make(corners); footprint && footprint->inscribed() > least / 3) return *footprint;
  }
}

inline std::vector<Eigen::Vector2d> placed(const std::vector<Eigen::Vector2d>& polygon, const Pose& pose) {
  const Eigen::Rotation2D<double> turn(pose.yaw);
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector2d& v : polygon) corners.push_back(pose.p + turn * v);
  return corners;
}

/// The area that a polygon shares with the square of a cell: cut off side by side (Sutherland & Hodgman 1974).
inline double shared_area(std::vector<Eigen::Vector2d> polygon, Cell cell) {
  for (int side = 0; side < 4; ++side) {
    const int axis = side / 2;
    const double sign = side % 2 == 0 ? 1 : -1;
    const double limit = sign * ((axis == 0 ? cell.x : cell.y) + side % 2);
    std::vector<Eigen::Vector2d> cut;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Eigen::Vector2d& a = polygon[i];
      const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
      const double da = sign * a[axis] - limit, db = sign * b[axis] - limit;
      if (da >= 0) cut.push_back(a);
      if ((da < 0) != (db < 0)) cut.push_back(a + da / (da - db) * (b - a));
    }
    polygon = std::move(cut);
  }
  return polygon.empty() ? 0 : area(polygon);
}

/// The largest area of a footprint that lies in one blocked cell, beyond the rectangle too.
inline double worst_overlap(const Plain& plain, const std::vector<Eigen::Vector2d>& polygon, const Pose& pose) {
  const std::vector<Eigen::Vector2d> corners = placed(polygon, pose);
  Eigen::Vector2d low = corners.front(), high = corners.front();
  for (const Eigen::Vector2d& p : corners) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  double worst = 0;
  for (int y = static_cast<int>(std::floor(low.y())); y <= static_cast<int>(std::floor(high.y())); ++y) {
    for (int x = static_cast<int>(std::floor(low.x())); x <= static_cast<int>(std::floor(high.x())); ++x) {
      if (!plain.at(x, y)) worst = std::max(worst, shared_area(corners, {x, y}));
    }
  }
  return worst;
}

inline Pose between(const Pose& a, const Pose& b, double share) {
  return {a.p + share * (b.p - a.p), a.yaw + share * wrapped(b.yaw - a.yaw)};
}

}  // namespace concord::test
