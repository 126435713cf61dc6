#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <unordered_map>

#include "core/label_corrections.hpp"
#include "core/lattice.hpp"

namespace concord {

/// Around voxels, seen from above: how far their centres reach in each of kSides directions, metres. The same in
/// whatever order they were added.
struct Outline {
  static constexpr int kSides = 32;

  std::array<double, kSides> reach;
  std::int32_t lowest = std::numeric_limits<std::int32_t>::max(), highest = std::numeric_limits<std::int32_t>::min();
  std::int64_t sum_x = 0, sum_y = 0, count = 0;  ///< of voxels, in voxels

  Outline() { reach.fill(std::numeric_limits<double>::lowest()); }
  void add(const Outline& other);
  bool operator==(const Outline&) const = default;
};

/// Direction i points to the angle of 2 pi i / kSides.
[[nodiscard]] const std::array<Eigen::Vector2d, Outline::kSides>& outline_directions();
/// @param resolution metres
[[nodiscard]] Outline outline_of(std::span<const VoxelIndex> voxels, double resolution);

/// The outlines of instances, kept brick by brick: a change costs its brick, and the bricks of the instances in it.
class Outlines {
 public:
  using InBrick = std::map<InstanceId, Outline>;

  /// What lies in a brick from now on.
  void set(BrickIndex index, InBrick now);
  void clear();
  /// Whether all() is another since it was asked last.
  [[nodiscard]] bool is_stale() const { return !stale_.empty(); }
  [[nodiscard]] const std::map<InstanceId, Outline>& all();

 private:
  std::unordered_map<BrickIndex, InBrick, IndexHash> by_brick_;
  std::map<InstanceId, std::set<BrickIndex>> bricks_;
  std::map<InstanceId, Outline> whole_;  ///< but of those that are stale
  std::set<InstanceId> stale_;
};

}  // namespace concord
