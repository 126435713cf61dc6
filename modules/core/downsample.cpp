#include "core/downsample.hpp"

#include <bit>
#include <cmath>
#include <map>

namespace concord {
namespace {

/// Summed in integers, so that the order of the voxels cannot matter.
struct Sum {
  std::int64_t x = 0, y = 0, z = 0;
  std::int64_t count = 0;
};

}  // namespace

std::vector<Eigen::Vector3f> downsample(const BrickMap& map, double resolution, double cell_size) {
  // Reckoned in single precision as PCL does, so that a centre on a boundary falls into the same cell.
  const float inverse = 1.0f / static_cast<float>(cell_size);
  const auto cell_of = [&](std::int32_t i) {
    const auto centre = static_cast<float>((i + 0.5) * resolution);
    return static_cast<std::int64_t>(std::floor(centre * inverse));
  };
  std::map<std::array<std::int64_t, 3>, Sum> cells;
  map.for_each_brick([&](BrickIndex index, const Brick& brick) {
    const VoxelMask occupied = brick.occupied();
    for (int word = 0; word < 8; ++word) {
      for (std::uint64_t bits = occupied[word]; bits != 0; bits &= bits - 1) {
        const VoxelIndex v = voxel_at(index, word * 64 + std::countr_zero(bits));
        Sum& sum = cells[{cell_of(v.x), cell_of(v.y), cell_of(v.z)}];
        sum.x += v.x;
        sum.y += v.y;
        sum.z += v.z;
        ++sum.count;
      }
    }
  });
  std::vector<Eigen::Vector3f> points;
  points.reserve(cells.size());
  for (const auto& [cell, sum] : cells) {
    const Eigen::Vector3d total(static_cast<double>(sum.x), static_cast<double>(sum.y), static_cast<double>(sum.z));
    const Eigen::Array3d mean_index = total.array() / static_cast<double>(sum.count);
    points.emplace_back(((mean_index + 0.5) * resolution).matrix().cast<float>());
  }
  return points;
}

}  // namespace concord
