#include <gtest/gtest.h>

#include <map>

#include "agent/sim/score.hpp"
#include "agent/sim/simulated_agent.hpp"
#include "core/compose.hpp"
#include "core/scan.hpp"

namespace concord {
namespace {

constexpr double kResolution = 0.1;

BrickMap map_whole_way(const RayCaster& world, AgentKind kind) {
  BrickMap map;
  SimulatedAgent agent(world, kind, 1);
  for (std::optional<Moment> moment = agent.next(); moment; moment = agent.next()) {
    const Result<CheckedScan> scan =
        checked({moment->T_agent_sensor, agent.sensor().trusted_range, moment->points}, kResolution);
    EXPECT_TRUE(scan && integrate(map, kResolution, scan->scan));
  }
  return map;
}

MapScore score_of(std::span<const Layer> layers, const Truth& truth) {
  return score(compose(layers, PinMap(), Policy::kMean, kResolution).values, truth);
}

std::map<std::string, bool> found(const MapScore& score) {
  std::map<std::string, bool> result;
  for (const FeatureScore& feature : score.features) result[feature.name] = feature.found;
  return result;
}

/// What the demo tells: together the agents know more than each alone, and some things only a person can add.
TEST(MergedScore, TogetherTheyFindMoreAndAPersonAddsTheRest) {
  const World world = make_warehouse(1);
  const RayCaster caster(world);
  const Truth truth = make_truth(world, kResolution);
  std::vector<BrickMap> maps;
  for (const AgentKind kind : {AgentKind::kLidar, AgentKind::kCamera, AgentKind::kHeadset}) {
    maps.push_back(map_whole_way(caster, kind));
  }
  const std::vector<Layer> layers{{&maps[0], start_pose(AgentKind::kLidar), 1},
                                  {&maps[1], start_pose(AgentKind::kCamera), 1},
                                  {&maps[2], start_pose(AgentKind::kHeadset), 1}};

  const MapScore lidar = score_of({layers.data(), 1}, truth), merged = score_of(layers, truth);
  EXPECT_GT(merged.precision, 0.98);
  EXPECT_GT(merged.recall, 0.95);
  EXPECT_GT(merged.recall, lidar.recall + 0.02);

  std::map<std::string, bool> alone = found(lidar), together = found(merged);
  EXPECT_TRUE(alone["shelf posts"] && together["shelf posts"]);
  EXPECT_FALSE(alone["low black stand"]) << "under the plane";
  EXPECT_FALSE(alone["narrow aisle"]) << "no way in";
  EXPECT_TRUE(together["low black stand"] && together["narrow aisle"]) << "a person has been there";
  EXPECT_FALSE(together["glass"] || together["reflective plate"]) << "nobody's sensor sees them";
}

}  // namespace
}  // namespace concord
