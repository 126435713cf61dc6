#include "semantic/detections/object_fit.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "semantic/models/solid_voxels.hpp"

namespace concord {
namespace {

constexpr double kResolution = 0.05;

void add_box(TriangleMesh& mesh, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                               (i & 4) != 0 ? high.z() : low.z());
  }
  for (const auto& t : {std::array<std::uint32_t, 3>{0, 2, 3},
                        {0, 3, 1},
                        {4, 5, 7},
                        {4, 7, 6},
                        {0, 1, 5},
                        {0, 5, 4},
                        {2, 6, 7},
                        {2, 7, 3},
                        {0, 4, 6},
                        {0, 6, 2},
                        {1, 3, 7},
                        {1, 7, 5}}) {
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

/// A chair: seat, back, four legs.
TriangleMesh chair() {
  TriangleMesh mesh;
  add_box(mesh, {-0.25, -0.25, 0.4}, {0.25, 0.25, 0.5});
  add_box(mesh, {-0.25, 0.2, 0.5}, {0.25, 0.25, 1.0});
  for (const double x : {-0.25, 0.2}) {
    for (const double y : {-0.25, 0.2}) add_box(mesh, {x, y, 0}, {x + 0.05, y + 0.05, 0.4});
  }
  return mesh;
}

Transform placed(double x, double y, double z, double yaw) {
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(x, y, z);
  return T;
}

/// What a scan of it would have, and the floor it stands on.
BrickMasks scanned(const Transform& T) {
  BrickMasks out = voxelize(chair(), {T, 1.0}, kResolution, Fill::kSurface)->surface;
  for (std::int32_t x = -60; x < 60; ++x) {
    for (std::int32_t y = -60; y < 60; ++y) out.insert({x, y, -1});
  }
  return out;
}

RC_GTEST_PROP(ObjectFit, BringsAChairBackFromADecimetreAndTenDegrees, ()) {
  const auto cm = [](int low, int high) { return *rc::gen::inRange(low, high + 1) * 0.01; };
  const Transform truth = placed(cm(-100, 100), cm(-100, 100), 0, cm(0, 628));
  Transform said = truth;
  said.translation() += Eigen::Vector3d(cm(-8, 8), cm(-8, 8), cm(0, 8));
  said.linear() *= Eigen::AngleAxisd(cm(-17, 17), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const auto points = surface_points(chair(), 1.0, kResolution);
  RC_ASSERT(points.has_value());
  const ObjectFit fit = fit_object(*points, scanned(truth), kResolution, said);
  const Eigen::Vector3d middle(0, 0, 0.5);
  RC_ASSERT((fit.T_map_model * middle - truth * middle).norm() < 1.5 * kResolution);
  // A voxel at its legs, 0.25 m from the middle, is 0.2 rad: what the lattice hides.
  RC_ASSERT(Eigen::AngleAxisd(truth.linear().transpose() * fit.T_map_model.linear()).angle() < 0.2);
  RC_ASSERT(fit.matched > 0.9);
  RC_ASSERT(fit.rms < kResolution);
}

TEST(ObjectFit, WhereNothingIsItStaysAndSaysSo) {
  const auto points = *surface_points(chair(), 1.0, kResolution);
  const Transform said = placed(20, 0, 0, 0.3);
  const ObjectFit fit = fit_object(points, scanned(placed(0, 0, 0, 0)), kResolution, said);
  EXPECT_EQ(fit.T_map_model.matrix(), said.matrix());
  EXPECT_EQ(fit.matched, 0.0);
  EXPECT_EQ(fit.shift, 0.0);
}

TEST(ObjectFit, DoesNotGoFartherThanItMay) {
  const auto points = *surface_points(chair(), 1.0, kResolution);
  for (const double away : {0.3, 0.6, 0.9, 1.2}) {
    const ObjectFit fit = fit_object(points, scanned(placed(0, 0, 0, 0)), kResolution, placed(away, 0, 0, 0));
    EXPECT_LE(fit.shift, kFarthestFit);
    EXPECT_LE(fit.turn, kMostTurned);
  }
}

TEST(ObjectFit, UnitsCountAndModelsThatAreNoneAreRefused) {
  const auto metres = *surface_points(chair(), 1.0, kResolution), doubled = *surface_points(chair(), 2.0, kResolution);
  EXPECT_LE(metres.size(), kMaxFitPoints);
  EXPECT_LE(doubled.size(), kMaxFitPoints);
  EXPECT_FALSE(surface_points(TriangleMesh(), 1.0, kResolution));
  EXPECT_FALSE(surface_points(chair(), std::nan(""), kResolution));
}

}  // namespace
}  // namespace concord
