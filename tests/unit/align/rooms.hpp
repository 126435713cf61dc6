#pragma once

#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "align/align.hpp"

namespace concord::test {

using Points = std::vector<Eigen::Vector3f>;
inline constexpr double kResolution = 0.05;
inline constexpr double kSpacing = 0.025;

/// The surface of an upright box, one point every kSpacing.
inline void add_box(Points& out, const Eigen::Vector3d& low, const Eigen::Vector3d& high, bool with_levels = true) {
  const auto steps = [](double length) { return static_cast<int>(std::ceil(length / kSpacing)); };
  const Eigen::Vector3d size = high - low;
  const auto add = [&](double x, double y, double z) {
    out.emplace_back((low + Eigen::Vector3d(x, y, z)).cast<float>());
  };
  for (int i = 0; i <= steps(size.x()); ++i) {
    for (int k = 0; k <= steps(size.z()); ++k) {
      add(i * kSpacing, 0.0, k * kSpacing);
      add(i * kSpacing, size.y(), k * kSpacing);
    }
    for (int j = 0; with_levels && j <= steps(size.y()); ++j) {
      add(i * kSpacing, j * kSpacing, 0.0);
      add(i * kSpacing, j * kSpacing, size.z());
    }
  }
  for (int j = 0; j <= steps(size.y()); ++j) {
    for (int k = 0; k <= steps(size.z()); ++k) {
      add(0.0, j * kSpacing, k * kSpacing);
      add(size.x(), j * kSpacing, k * kSpacing);
    }
  }
}

/// 6 x 4.5 x 2.6 m with a corner cut out, shelves, a table and a pillar: nothing in it is symmetric.
inline Points room() {
  Points out;
  add_box(out, {-3.0, -2.2, 0.0}, {3.0, 2.3, 2.6});
  add_box(out, {1.8, 1.2, 0.0}, {3.0, 2.3, 2.6}, false);
  add_box(out, {-2.9, -2.1, 0.0}, {-2.5, -0.3, 1.8});
  add_box(out, {-0.8, -0.4, 0.65}, {0.9, 0.5, 0.75});
  add_box(out, {1.5, -1.5, 0.0}, {1.8, -1.2, 2.6}, false);
  add_box(out, {-1.2, 1.7, 0.0}, {0.2, 2.2, 1.1});
  return out;
}

/// Another room: 5 x 5.5 m, other furniture.
inline Points other_room() {
  Points out;
  add_box(out, {-2.5, -2.5, 0.0}, {2.5, 3.0, 2.6});
  add_box(out, {-2.4, 1.0, 0.0}, {-1.4, 2.9, 2.0});
  add_box(out, {0.3, -1.3, 0.0}, {1.9, -0.6, 0.8});
  add_box(out, {1.2, 1.8, 0.0}, {1.6, 2.2, 1.4});
  return out;
}

/// Two walls, floor and ceiling along x, open at both ends.
inline Points corridor(double begin, double end) {
  Points out;
  for (double x = begin; x < end; x += kSpacing) {
    for (double u = 0.0; u <= 2.4; u += kSpacing) {
      out.emplace_back(Eigen::Vector3d(x, 0.0, u).cast<float>());
      out.emplace_back(Eigen::Vector3d(x, 2.0, u).cast<float>());
      if (u <= 2.0) out.emplace_back(Eigen::Vector3d(x, u, 0.0).cast<float>());
      if (u <= 2.0) out.emplace_back(Eigen::Vector3d(x, u, 2.4).cast<float>());
    }
  }
  return out;
}

template <class Keep>
Points kept(const Points& points, Keep&& keep) {
  Points out;
  for (const Eigen::Vector3f& p : points) {
    if (keep(p)) out.push_back(p);
  }
  return out;
}

inline Points moved(const Points& points, const Transform& T) {
  Points out;
  for (const Eigen::Vector3f& p : points) out.push_back((T * p.cast<double>()).cast<float>());
  return out;
}

inline Points mirrored(const Points& points) {
  Points out;
  for (const Eigen::Vector3f& p : points) out.emplace_back(-p.x(), p.y(), p.z());
  return out;
}

inline Transform transform(double x, double y, double z, double yaw, double pitch = 0.0, double roll = 0.0) {
  Transform T = Transform::Identity();
  T.translate(Eigen::Vector3d(x, y, z));
  T.rotate(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()));
  return T;
}

inline double degrees(double d) { return d * std::numbers::pi / 180.0; }

inline AlignMap cloud_map(const Points& points, int threads = 1) {
  return make_align_map(points, kResolution, threads).value();
}

/// Metres at the source's origin.
inline double metres_off(const Transform& a, const Transform& b) { return (a.translation() - b.translation()).norm(); }
inline double degrees_off(const Transform& a, const Transform& b) {
  return Eigen::AngleAxisd(Eigen::Matrix3d(a.linear().transpose() * b.linear())).angle() * 180.0 / std::numbers::pi;
}

/// The voxels that hold the points, as an agent that marks no free space would send them.
inline BrickMap voxels_of(const Points& points) {
  std::map<BrickIndex, DenseBrick> bricks;
  for (const Eigen::Vector3f& p : points) {
    const VoxelIndex voxel = voxel_of(p.cast<double>(), kResolution);
    const auto [it, is_new] = bricks.try_emplace(brick_of(voxel));
    if (is_new) it->second.fill(kUnknown);
    it->second[static_cast<std::size_t>(local_of(voxel))] = kOccupied;
  }
  BrickMap map;
  for (const auto& [index, dense] : bricks) map.set(index, Brick::from_dense(dense));
  return map;
}

/// The room and a part of it in another frame, overlapping by over half.
inline Points left_part() {
  return kept(room(), [](const Eigen::Vector3f& p) { return p.x() < 1.6F; });
}
inline const Transform kT_left_right = transform(3.0, -1.0, 0.4, 0.7);
inline Points right_part() {
  return moved(kept(room(), [](const Eigen::Vector3f& p) { return p.x() > -1.7F; }), kT_left_right.inverse());
}

}  // namespace concord::test
