#include "agent/sim/score.hpp"

#include "agent/sim/sensors.hpp"

namespace concord {
namespace {

constexpr double kFoundShare = 0.5;
constexpr double kBehind = 1e-6;  // a hit lies on a surface, perhaps between two voxels: look just behind it

void insert_seen(VoxelSet& seen, const VoxelSet& all, const RayCaster& world, AgentKind kind, double resolution) {
  const Sensor sensor = make_sensor(kind);
  const Trajectory trajectory(kind);
  for (int scan = 0; scan / sensor.scans_per_second <= trajectory.duration(); ++scan) {
    const Transform T_map_sensor = trajectory.T_map_sensor(scan / sensor.scans_per_second);
    for (const Eigen::Vector3d& direction : sensor.directions) {
      const Ray ray{T_map_sensor.translation(), T_map_sensor.linear() * direction};
      const std::optional<Hit> hit = world.cast(ray, sensor.trusted_range, Glass::kStops);
      if (!hit || hit->distance < sensor.min_range) continue;
      const VoxelIndex voxel = voxel_of(ray.origin + (hit->distance + kBehind) * ray.direction, resolution);
      if (all.contains(voxel)) seen.insert(voxel);
    }
  }
}

/// Share of `wanted` that is in `present` or next to it; 0 of nothing.
double share_near(const VoxelSet& wanted, const VoxelSet& present) {
  std::size_t count = 0, near = 0;
  wanted.for_each([&](VoxelIndex voxel) {
    ++count;
    if (present.contains_near(voxel)) ++near;
  });
  return count == 0 ? 0 : static_cast<double>(near) / static_cast<double>(count);
}

}  // namespace

Truth make_truth(const World& world, double resolution) {
  Truth truth;
  truth.surface = surface(world, resolution);
  const RayCaster caster(world);
  for (const AgentKind kind : {AgentKind::kLidar, AgentKind::kCamera, AgentKind::kHeadset}) {
    insert_seen(truth.observable, truth.surface, caster, kind, resolution);
  }
  for (const Feature& feature : world.features) {
    truth.features.emplace_back(feature.name, surface(world, feature, resolution));
  }
  return truth;
}

MapScore score(const BrickMap& map, const Truth& truth) {
  const VoxelSet occupied = occupied_voxels(map);
  MapScore result;
  result.precision = share_near(occupied, truth.surface);
  result.recall = share_near(truth.observable, occupied);
  for (const auto& [name, voxels] : truth.features) {
    const double share = share_near(voxels, occupied);
    result.features.push_back({name, share, share >= kFoundShare});
  }
  return result;
}

}  // namespace concord
