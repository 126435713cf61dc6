#include "agent/sim/simulated_agent.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace concord {
namespace {

class SimulatedAgents : public testing::TestWithParam<AgentKind> {
 protected:
  World world_ = make_warehouse(1);
  RayCaster caster_{world_};
};

TEST_P(SimulatedAgents, FollowTheirSeed) {
  SimulatedAgent a(caster_, GetParam(), 7), b(caster_, GetParam(), 7), c(caster_, GetParam(), 8);
  for (int i = 0; i < 4; ++i) {
    const std::optional<Moment> ma = a.next(), mb = b.next(), mc = c.next();
    ASSERT_TRUE(ma && mb && mc);
    EXPECT_TRUE(ma->T_agent_base.matrix() == mb->T_agent_base.matrix());
    EXPECT_EQ(ma->points, mb->points);
    EXPECT_NE(ma->points, mc->points);
    EXPECT_GT(ma->points.size(), 500U);
  }
}

TEST_P(SimulatedAgents, DriftByCentimetres) {
  SimulatedAgent run(caster_, GetParam(), 7);
  double furthest = 0;
  int moments = 0;
  std::optional<Moment> last;
  for (std::optional<Moment> moment = run.next(); moment; moment = run.next()) {
    const Transform believed = start_pose(GetParam()) * moment->T_agent_base;
    furthest = std::max(furthest, (believed.translation() - moment->T_map_base.translation()).norm());
    last = std::move(moment);
    ++moments;
  }
  EXPECT_GT(furthest, 0.001);
  EXPECT_LT(furthest, 0.1);
  ASSERT_TRUE(last);
  EXPECT_NEAR(last->time, run.duration(), 1 / run.sensor().scans_per_second);
  EXPECT_GT(moments, 100);
}

TEST_P(SimulatedAgents, MeasureTheSurface) {
  SimulatedAgent run(caster_, GetParam(), 7);
  const std::optional<Moment> moment = run.next();
  ASSERT_TRUE(moment);
  const VoxelSet all = surface(world_, 0.05);
  std::size_t trusted = 0, near = 0;
  for (const Eigen::Vector3f& p_agent : moment->points) {
    const Eigen::Vector3d p = start_pose(GetParam()) * p_agent.cast<double>();
    if ((p_agent.cast<double>() - moment->T_agent_sensor.translation()).norm() > run.sensor().trusted_range) continue;
    ++trusted;
    if (all.contains_near(voxel_of(p, 0.05))) ++near;
  }
  EXPECT_GT(trusted, 400U);
  EXPECT_GT(static_cast<double>(near), 0.97 * static_cast<double>(trusted));
}

INSTANTIATE_TEST_SUITE_P(All, SimulatedAgents,
                         testing::Values(AgentKind::kLidar, AgentKind::kCamera, AgentKind::kHeadset));

TEST(Measure, MirrorAndGlassReturnNothingBlackLittle) {
  const auto share = [](Material material) {
    World world;
    world.solids.push_back({{1.5, 0, 0}, {0.1, 5, 5}, 0, material});
    Random random(1);
    Sensor sensor = make_sensor(AgentKind::kHeadset);
    sensor.directions.assign(10000, Eigen::Vector3d::UnitX());
    const RayCaster caster(world);
    return static_cast<double>(measure(sensor, caster, Transform::Identity(), random).size()) / 10000;
  };
  EXPECT_EQ(share(Material::kOpaque), 1);
  EXPECT_EQ(share(Material::kGlass), 0);
  EXPECT_EQ(share(Material::kMirror), 0);
  EXPECT_NEAR(share(Material::kBlack), make_sensor(AgentKind::kHeadset).black_return, 0.02);
}

TEST(Measure, NoiseIsAsStated) {
  World world;
  world.solids.push_back({{4.1, 0, 0}, {0.1, 50, 50}, 0, Material::kOpaque});
  const RayCaster caster(world);
  Sensor sensor = make_sensor(AgentKind::kCamera);
  sensor.directions.assign(20000, Eigen::Vector3d::UnitX());
  Random random(2);
  double sum = 0, squares = 0;
  for (const Eigen::Vector3d& p : measure(sensor, caster, Transform::Identity(), random)) {
    sum += p.x() - 4;
    squares += (p.x() - 4) * (p.x() - 4);
  }
  const double deviation = sensor.noise + sensor.noise_growth * 16;
  EXPECT_NEAR(sum / 20000, 0, deviation / 20);
  EXPECT_NEAR(std::sqrt(squares / 20000), deviation, deviation / 20);
}

}  // namespace
}  // namespace concord
