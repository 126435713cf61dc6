#include "building.hpp"

#include <cmath>
#include <random>

#include "core/log_odds.hpp"

namespace concord::soak {
namespace {

bool is_wall(const Eigen::Vector3d& p) {
  const auto near = [](double a, double b) { return std::abs(a - b) < kResolution; };
  if (near(p.z(), 0) || near(std::abs(p.x()), kHalfWidth - 1) || near(std::abs(p.y()), kHalfWidth - 1)) return true;
  return near(p.x(), 1.0) && std::abs(p.y()) > 1.0;
}

BrickMap seen_by(std::mt19937& random) {
  std::uniform_real_distribution<double> chance(0, 1);
  std::map<BrickIndex, DenseBrick> bricks;
  const auto side = static_cast<std::int32_t>(kHalfWidth / kResolution);
  const auto height = static_cast<std::int32_t>(kHeight / kResolution);
  for (std::int32_t z = -1; z < height; ++z) {
    for (std::int32_t y = -side; y < side; ++y) {
      for (std::int32_t x = -side; x < side; ++x) {
        if (chance(random) < 0.2) continue;  // not seen
        const VoxelIndex voxel{x, y, z};
        const bool mistaken = chance(random) < 0.01;
        const auto [it, is_new] = bricks.try_emplace(brick_of(voxel));
        if (is_new) it->second.fill(kUnknown);
        it->second[local_of(voxel)] = is_wall(centre_of(voxel, kResolution)) != mistaken ? kOccupied : kFree;
      }
    }
  }
  BrickMap map;
  for (const auto& [index, dense] : bricks) map.set(index, Brick::from_dense(dense));
  return map;
}

}  // namespace

std::map<std::string, BrickMap> submaps(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::map<std::string, BrickMap> out;
  for (const char* robot : {"robot1", "robot2"}) out[robot] = seen_by(random);
  return out;
}

}  // namespace concord::soak
