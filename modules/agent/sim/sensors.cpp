#include "agent/sim/sensors.hpp"

#include <cmath>
#include <numbers>

namespace concord {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

std::vector<Eigen::Vector3d> rings(int count, double half_elevation, int steps) {
  std::vector<Eigen::Vector3d> directions;
  for (int ring = 0; ring < count; ++ring) {
    const double elevation = half_elevation * (2.0 * ring / (count - 1) - 1);
    for (int step = 0; step < steps; ++step) {
      const double azimuth = 2 * std::numbers::pi * step / steps;
      directions.emplace_back(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                              std::sin(elevation));
    }
  }
  return directions;
}

std::vector<Eigen::Vector3d> pinhole(int columns, int rows, double half_width, double half_height) {
  std::vector<Eigen::Vector3d> directions;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double y = std::tan(half_width) * (1 - 2 * (column + 0.5) / columns);
      const double z = std::tan(half_height) * (1 - 2 * (row + 0.5) / rows);
      directions.push_back(Eigen::Vector3d(1, y, z).normalized());
    }
  }
  return directions;
}

bool returns(const Sensor& sensor, Material material, double range, Random& random) {
  if (range < sensor.min_range) return false;
  switch (material) {
    case Material::kOpaque: return true;
    case Material::kBlack: return range < sensor.black_range && random.uniform() < sensor.black_return;
    case Material::kGlass:
    case Material::kMirror: break;
  }
  return false;
}

}  // namespace

Sensor make_sensor(AgentKind kind) {
  switch (kind) {
    case AgentKind::kLidar:
      return {.directions = rings(32, 15 * kDegree, 480),
              .min_range = 0.4,
              .max_range = 25,
              .trusted_range = 25,
              .noise = 0.01,
              .noise_growth = 0,
              .black_range = 0,
              .black_return = 0,
              .scans_per_second = 2};
    case AgentKind::kCamera:
      return {.directions = pinhole(80, 60, 43.5 * kDegree, 29 * kDegree),
              .min_range = 0.3,
              .max_range = 8,
              .trusted_range = 5,
              .noise = 0.002,
              .noise_growth = 0.0015,
              .black_range = 1.0,
              .black_return = 0.02,
              .scans_per_second = 5};
    case AgentKind::kHeadset: break;
  }
  return {.directions = pinhole(96, 72, 40 * kDegree, 32 * kDegree),
          .min_range = 0.3,
          .max_range = 3.5,
          .trusted_range = 3.5,
          .noise = 0.004,
          .noise_growth = 0,
          .black_range = 2.2,
          .black_return = 0.35,
          .scans_per_second = 5};
}

std::vector<Eigen::Vector3d> measure(const Sensor& sensor, const RayCaster& world, const Transform& T_map_sensor,
                                     Random& random) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(sensor.directions.size());
  for (const Eigen::Vector3d& direction : sensor.directions) {
    const Ray ray{T_map_sensor.translation(), T_map_sensor.linear() * direction};
    const std::optional<Hit> hit = world.cast(ray, sensor.max_range, Glass::kLetsThrough);
    if (!hit || !returns(sensor, world.material(hit->solid), hit->distance, random)) continue;
    const double deviation = sensor.noise + sensor.noise_growth * hit->distance * hit->distance;
    points.push_back(direction * (hit->distance + deviation * random.normal()));
  }
  return points;
}

}  // namespace concord
