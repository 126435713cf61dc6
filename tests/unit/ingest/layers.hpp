#pragma once

#include <string>
#include <utility>

#include "core/octomap_writer.hpp"
#include "ingest/ingest.hpp"

namespace concord::testing {

inline constexpr double kResolution = 0.1;

/// Every voxel from `low` to `high` (included) has `value`.
[[nodiscard]] inline BrickMap box(VoxelIndex low, VoxelIndex high, LogOdds value) {
  BrickMap map;
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) {
        const VoxelIndex voxel{x, y, z};
        DenseBrick dense;
        dense.fill(kUnknown);
        if (const Brick* brick = map.find(brick_of(voxel))) brick->to_dense(dense);
        dense[static_cast<std::size_t>(local_of(voxel))] = value;
        map.set(brick_of(voxel), Brick::from_dense(dense));
      }
    }
  }
  return map;
}

[[nodiscard]] inline Bytes octomap_of(const BrickMap& map, OctomapFormat format = OctomapFormat::kFull) {
  return write_octomap_data(map, format).value();
}

/// Spelled out, because g++ 12 warns wrongly of `"f" + std::to_string(1)`.
[[nodiscard]] inline std::string numbered(std::string prefix, int number) {
  prefix += std::to_string(number);
  return prefix;
}

/// What someone knows who is told nothing but the changes.
class Mirror {
 public:
  void apply(const Change& change, const BrickMap& layer) {
    if (change.new_frame) map_.clear();
    for (const BrickIndex index : change.bricks) {
      const Brick* brick = layer.find(index);
      map_.set(index, brick != nullptr ? *brick : Brick{});
    }
  }
  [[nodiscard]] const BrickMap& map() const { return map_; }

 private:
  BrickMap map_;
};

}  // namespace concord::testing
