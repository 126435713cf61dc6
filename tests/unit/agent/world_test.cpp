#include "agent/sim/world.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "agent/sim/ray_caster.hpp"
#include "agent/sim/trajectory.hpp"

namespace concord {
namespace {

constexpr double kResolution = 0.05;

bool same(const World& a, const World& b) {
  if (a.solids.size() != b.solids.size()) return false;
  for (std::size_t i = 0; i < a.solids.size(); ++i) {
    if (a.solids[i].centre != b.solids[i].centre || a.solids[i].half != b.solids[i].half ||
        a.solids[i].yaw != b.solids[i].yaw) {
      return false;
    }
  }
  return true;
}

TEST(Warehouse, FollowsItsSeed) {
  EXPECT_TRUE(same(make_warehouse(5), make_warehouse(5)));
  EXPECT_FALSE(same(make_warehouse(5), make_warehouse(6)));
}

TEST(Surface, OfOneTurnedBox) {
  World world;
  world.solids.push_back({{1, 2, 0.5}, {0.4, 0.3, 0.5}, 0.7, Material::kOpaque});
  const VoxelSet set = surface(world, kResolution);

  // Points on the faces lie in the set; the set's voxels touch the box and none lies wholly inside.
  const Eigen::AngleAxisd turn(0.7, Eigen::Vector3d::UnitZ());
  int points = 0;
  for (double u = -0.999; u < 1; u += 0.037) {
    for (double v = -0.999; v < 1; v += 0.037) {
      for (const Eigen::Vector3d& p : {Eigen::Vector3d(0.4, 0.3 * u, 0.5 * v),
                                       {0.4 * u, -0.3, 0.5 * v},
                                       Eigen::Vector3d(0.4 * u, 0.3 * v, 0.4999999)}) {
        EXPECT_TRUE(set.contains(voxel_of(turn * p + world.solids[0].centre, kResolution)));
        ++points;
      }
    }
  }
  EXPECT_GT(points, 1000);
  set.for_each([&](VoxelIndex voxel) {
    const Eigen::Vector3d p = turn.inverse() * (centre_of(voxel, kResolution) - world.solids[0].centre);
    const double reach = kResolution * std::sqrt(3.0) / 2;
    const Eigen::Array3d beyond = p.array().abs() - world.solids[0].half.array();
    EXPECT_LT(beyond.maxCoeff(), reach);
    EXPECT_GT(beyond.maxCoeff(), -reach);
  });
}

TEST(Surface, CoversWhatRaysHit) {
  const World world = make_warehouse(2);
  const RayCaster caster(world);
  const VoxelSet set = surface(world, kResolution);
  for (int i = 0; i < 2000; ++i) {
    const Ray ray{{16.5, 8, 1.2}, Eigen::Vector3d(std::cos(i), std::sin(i), 0.3 * std::sin(7 * i)).normalized()};
    const std::optional<Hit> hit = caster.cast(ray, 30, Glass::kStops);
    if (hit) {
      EXPECT_TRUE(set.contains_near(voxel_of(ray.origin + hit->distance * ray.direction, kResolution)));
    }
  }
}

TEST(Features, LieOnTheSurface) {
  const World world = make_warehouse(2);
  const VoxelSet all = surface(world, kResolution);
  std::vector<std::string> names;
  for (const Feature& feature : world.features) {
    names.push_back(feature.name);
    const VoxelSet own = surface(world, feature, kResolution);
    EXPECT_GT(own.size(), 100U) << feature.name;
    own.for_each([&](VoxelIndex voxel) {
      EXPECT_TRUE(all.contains(voxel)) << feature.name;
      if (feature.edit_box) {
        EXPECT_LT(feature.edit_box->exteriorDistance(centre_of(voxel, kResolution)), kResolution);
      }
    });
  }
  EXPECT_EQ(names,
            (std::vector<std::string>{"glass", "shelf posts", "low black stand", "narrow aisle", "reflective plate"}));
}

TEST(Errand, TheGlassStandsAcrossIt) {
  const World world = make_warehouse(2);
  const RayCaster caster(world);
  const Eigen::Vector2d way = world.through_glass.to - world.through_glass.from;
  for (const double z : {0.15, 0.5, 1.0, 1.7}) {
    const Ray ray{{world.through_glass.from.x(), world.through_glass.from.y(), z},
                  Eigen::Vector3d(way.x(), way.y(), 0).normalized()};
    const std::optional<Hit> stopped = caster.cast(ray, way.norm(), Glass::kStops);
    ASSERT_TRUE(stopped);
    EXPECT_EQ(caster.material(stopped->solid), Material::kGlass);
    EXPECT_FALSE(caster.cast(ray, way.norm(), Glass::kLetsThrough));
  }
}

class Trajectories : public testing::TestWithParam<AgentKind> {};

TEST_P(Trajectories, KeepClearOfEverything) {
  const World world = make_warehouse(2);
  const Trajectory trajectory(GetParam());
  const double radius = GetParam() == AgentKind::kHeadset ? 0.22 : 0.3;
  EXPECT_GT(trajectory.duration(), 40);
  EXPECT_LT(trajectory.duration(), 75);
  for (double time = 0; time < trajectory.duration(); time += 0.05) {
    const Eigen::Vector3d base = trajectory.T_map_base(time).translation();
    for (const Solid& solid : world.solids) {
      if (solid.centre.z() - solid.half.z() > 1.9 || solid.centre.z() + solid.half.z() < 0.01) continue;
      const Eigen::Vector3d p = Eigen::AngleAxisd(-solid.yaw, Eigen::Vector3d::UnitZ()) * (base - solid.centre);
      const Eigen::Array2d beyond = (p.head<2>().array().abs() - solid.half.head<2>().array()).max(0);
      EXPECT_GT(beyond.matrix().norm(), radius)
          << "at " << time << " s: " << base.transpose() << " near " << solid.centre.transpose();
    }
  }
}

TEST_P(Trajectories, StartAtTheAgentsFrameAndMoveSmoothly) {
  const Trajectory trajectory(GetParam());
  const Transform start = start_pose(GetParam());
  EXPECT_LT((start.translation() - trajectory.T_map_base(0).translation()).norm(), 1e-9);
  EXPECT_NEAR(start.linear()(2, 2), 1, 1e-12) << "level";
  for (double time = 0; time < trajectory.duration(); time += 0.02) {
    const Transform step = trajectory.T_map_base(time).inverse() * trajectory.T_map_base(time + 0.02);
    EXPECT_LT(step.translation().norm(), 0.03);
    EXPECT_LT(Eigen::AngleAxisd(step.linear()).angle(), 0.06);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Trajectories,
                         testing::Values(AgentKind::kLidar, AgentKind::kCamera, AgentKind::kHeadset));

TEST(AgentKinds, HaveNames) {
  EXPECT_EQ(agent_kind("lidar"), AgentKind::kLidar);
  EXPECT_EQ(agent_kind("headset"), AgentKind::kHeadset);
  EXPECT_FALSE(agent_kind("sonar"));
}

}  // namespace
}  // namespace concord
