#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

#include "random_shapes.hpp"
#include "shape_oracle.hpp"

namespace concord {
namespace {

namespace oracle = shape_oracle;

constexpr double kResolution = 0.05;
/// Where the oracle and the rule may differ, in voxels: kOnFace, and what a flat side is widened by.
constexpr long double kEither = 1e-5L;

oracle::Point exact(const Eigen::Vector3d& p) { return p.cast<long double>(); }

/// Checks every voxel around the origin: those that `must(voxel)` are selected, and none that not even `may(voxel)`.
template <class Must, class May>
void agrees(const Shape& shape, const Transform& T_map_frame, int reach, Must must, May may) {
  const auto voxels = select(shape, T_map_frame, kResolution, 1'000'000);
  if (!voxels) RC_FAIL(voxels.error().message);
  RC_ASSERT(std::ranges::is_sorted(*voxels));
  RC_ASSERT(std::ranges::adjacent_find(*voxels) == voxels->end());
  for (const VoxelIndex& v : *voxels) RC_ASSERT(std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) < reach);
  for (std::int32_t x = -reach; x < reach; ++x)
    for (std::int32_t y = -reach; y < reach; ++y)
      for (std::int32_t z = -reach; z < reach; ++z) {
        const VoxelIndex v{x, y, z};
        const bool selected = std::ranges::binary_search(*voxels, v);
        if (selected && !may(v)) RC_FAIL("selected without need");
        if (!selected && must(v)) RC_FAIL("left out");
      }
}

/// @pre a volume's own corners are within 6 voxels of the origin of its frame.
void agrees(const Volume& volume, const Transform& T_map_frame, const oracle::Solid& solid) {
  const Shape shape = std::visit([](const auto& v) { return Shape(v); }, volume);
  agrees(
      shape, T_map_frame, 14,
      [&](VoxelIndex v) { return oracle::meets(solid, oracle::cell_of(v, kResolution, -kEither)); },
      [&](VoxelIndex v) { return oracle::meets(solid, oracle::cell_of(v, kResolution, kEither)); });
}

std::vector<oracle::FlatPoint> rectangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return {{a.x(), a.y()}, {b.x(), a.y()}, {b.x(), b.y()}, {a.x(), b.y()}};
}

/// Within half a metre of a frame that is within 0.15 m of the map's origin.
constexpr double kFrame = 0.15, kReach = 0.2;

RC_GTEST_PROP(SelectVolume, BoxTakesTheVoxelsItSharesVolumeWith, ()) {
  const Eigen::Vector3d a = any_point(kReach), b = any_point(kReach);
  const Box box{a.cwiseMin(b), a.cwiseMax(b)};
  RC_PRE((box.max - box.min).head<2>().minCoeff() > 1e-4);  // the oracle wants an area; height may be none
  const Transform T = any_transform(kFrame);
  agrees(box, T, {T.cast<long double>(), rectangle(box.min, box.max), box.min.z(), box.max.z()});
}

RC_GTEST_PROP(SelectVolume, OrientedBoxTakesTheVoxelsItSharesVolumeWith, ()) {
  const Eigen::Vector3d half = any_point(kReach).cwiseAbs();
  RC_PRE(half.head<2>().minCoeff() > 1e-4);
  const Transform T_map_frame = any_transform(kFrame / 2), T_frame_box = any_transform(kFrame / 2);
  agrees(OrientedBox{T_frame_box, 2 * half}, T_map_frame,
         {(T_map_frame * T_frame_box).cast<long double>(), rectangle(-half, half), -half.z(), half.z()});
}

RC_GTEST_PROP(SelectVolume, PrismTakesTheVoxelsItSharesVolumeWith, ()) {
  const auto points = any_polygon(kReach * 1.7);
  const double a = any_number(-kReach, kReach), b = any_number(-kReach, kReach);
  const Transform T = any_transform(kFrame);
  std::vector<oracle::FlatPoint> corners;
  for (const auto& p : points) corners.push_back(p.cast<long double>());
  agrees(Prism{points, std::min(a, b), std::max(a, b)}, T,
         {T.cast<long double>(), corners, std::min(a, b), std::max(a, b)});
}

RC_GTEST_PROP(SelectLine, TakesWhatItTouchesAndWhatIsWithinHalfItsThickness, ()) {
  Line line;
  for (int left = *rc::gen::inRange(2, 5); left > 0; --left) line.points.push_back(any_point(kReach));
  if (*rc::gen::arbitrary<bool>()) line.thickness = any_number(0, 0.2);
  const Transform T = any_transform(kFrame);
  const auto reached = [&](VoxelIndex v, long double grown) {
    const oracle::Cell cell = oracle::cell_of(v, kResolution, grown);
    for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
      const oracle::Point a = exact(T * line.points[i]), b = exact(T * line.points[i + 1]);
      if (oracle::meets({a, b}, cell)) return true;
      const long double radius = line.thickness / 2 + grown * kResolution;
      if (line.thickness > 0 && oracle::distance(cell.centre, a, b) <= radius) return true;
    }
    return false;
  };
  agrees(
      line, T, 14, [&](VoxelIndex v) { return reached(v, -kEither); },
      [&](VoxelIndex v) { return reached(v, kEither); });
}

RC_GTEST_PROP(SelectArea, TakesWhatItTouchesAndWhatIsWithinHalfItsThickness, ()) {
  // Around the origin, so triangles of the oracle's own fan from there: a star is seen from its middle.
  Area area;
  for (const auto& p : any_polygon(kReach * 1.7)) area.points.emplace_back(p.x(), p.y(), 0);
  if (*rc::gen::arbitrary<bool>()) area.thickness = any_number(0, 0.2);
  const Transform T = any_transform(kFrame);
  const oracle::Point middle = exact(T.translation());
  const auto reached = [&](VoxelIndex v, long double grown) {
    const oracle::Cell cell = oracle::cell_of(v, kResolution, grown);
    for (std::size_t i = 0; i < area.points.size(); ++i) {
      const oracle::Point a = exact(T * area.points[i]), b = exact(T * area.points[(i + 1) % area.points.size()]);
      if (oracle::meets({middle, a, b}, cell)) return true;
      const long double radius = area.thickness / 2 + grown * kResolution;
      if (area.thickness > 0 && oracle::distance(cell.centre, middle, a, b) <= radius) return true;
    }
    return false;
  };
  agrees(
      area, T, 14, [&](VoxelIndex v) { return reached(v, -kEither); },
      [&](VoxelIndex v) { return reached(v, kEither); });
}

}  // namespace
}  // namespace concord
