#include "core/scan.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <string>

#include "core/ray.hpp"

namespace concord {
namespace {

/// Free and hit voxels of the bricks that a scan touches. An open-addressed table: it is what a ray spends its time on.
class ScanMasks {
 public:
  struct Entry {
    BrickIndex brick;
    VoxelMask free{};
    VoxelMask hit{};
  };

  ScanMasks() : slots_(1024, kNone) {}

  void free(VoxelIndex v) { set_bit(of(v).free, v); }
  void hit(VoxelIndex v) { set_bit(of(v).hit, v); }

  /// More than kMaxScanBricks: what came after has been left out.
  [[nodiscard]] bool overflowed() const { return entries_.size() > kMaxScanBricks; }

  [[nodiscard]] std::vector<Entry> take_sorted() {
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.brick < b.brick; });
    return std::move(entries_);
  }

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  static void set_bit(VoxelMask& mask, VoxelIndex v) {
    const int local = local_of(v);
    mask[local / 64] |= std::uint64_t{1} << (local % 64);
  }

  Entry& of(VoxelIndex v) {
    const BrickIndex brick = brick_of(v);
    // A ray stays in a brick for several cells.
    if (!entries_.empty() && entries_[last_].brick == brick) return entries_[last_];
    std::size_t slot = slot_of(brick);
    if (slots_[slot] == kNone && !overflowed()) {
      if (2 * entries_.size() >= slots_.size()) slot = grow(brick);
      slots_[slot] = static_cast<std::uint32_t>(entries_.size());
      entries_.push_back({brick});
    }
    last_ = slots_[slot] == kNone ? 0 : slots_[slot];
    return entries_[last_];
  }

  [[nodiscard]] std::size_t slot_of(BrickIndex brick) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = IndexHash{}(brick)&mask;
    while (slots_[slot] != kNone && entries_[slots_[slot]].brick != brick) slot = (slot + 1) & mask;
    return slot;
  }

  std::size_t grow(BrickIndex brick) {
    slots_.assign(2 * slots_.size(), kNone);
    for (std::uint32_t i = 0; i < entries_.size(); ++i) slots_[slot_of(entries_[i].brick)] = i;
    return slot_of(brick);
  }

  std::vector<std::uint32_t> slots_;  ///< index into entries_; a power of two of them
  std::vector<Entry> entries_;
  std::size_t last_ = 0;
};

/// Where a ray ends, in units of a voxel's edge, and whether something is there.
struct RayEnd {
  Eigen::Vector3d at;
  bool hit;
};

/// What a scan's rays are measured from, in units of a voxel's edge.
struct Rays {
  Rays(const Scan& scan, double voxel)
      : resolution(voxel),
        origin(scan.T_agent_sensor->translation() / voxel),
        reach(scan.max_range > 0 ? std::min(scan.max_range / voxel, kMaxRayLength) : kMaxRayLength) {}

  [[nodiscard]] RayEnd end(const Eigen::Vector3f& point) const {
    const Eigen::Vector3d p = point.cast<double>() / resolution;
    const double distance = (p - origin).norm();
    if (distance <= reach) return {p, true};
    return {origin + (p - origin) * (reach / distance), false};
  }

  double resolution;
  Eigen::Vector3d origin;
  double reach;
};

bool in_bounds(const Eigen::Vector3d& p, double resolution) {
  return p.allFinite() && p.cwiseAbs().maxCoeff() / resolution < kMaxVoxel - 1;
}

LogOdds updated(LogOdds before, LogOdds by) {
  const int sum = (is_known(before) ? before : 0) + by;
  return static_cast<LogOdds>(std::clamp<int>(sum, kFree, kOccupied));
}

void add(DenseBrick& dense, const VoxelMask& where, LogOdds by) {
  for (int word = 0; word < 8; ++word) {
    for (std::uint64_t bits = where[word]; bits != 0; bits &= bits - 1) {
      LogOdds& value = dense[word * 64 + std::countr_zero(bits)];
      value = updated(value, by);
    }
  }
}

Brick updated(const Brick* before, const ScanMasks::Entry& entry) {
  DenseBrick dense;
  if (before != nullptr) {
    before->to_dense(dense);
  } else {
    dense.fill(kUnknown);
  }
  VoxelMask free = entry.free;
  for (int word = 0; word < 8; ++word) free[word] &= ~entry.hit[word];
  add(dense, free, kMiss);
  add(dense, entry.hit, kHit);
  return Brick::from_dense(dense);
}

void trace(const Scan& scan, double resolution, ScanMasks& masks) {
  if (!scan.T_agent_sensor) {
    for (const Eigen::Vector3f& point : scan.points) masks.hit(voxel_of(point.cast<double>() / resolution, 1.0));
    return;
  }
  const Rays rays(scan, resolution);
  for (const Eigen::Vector3f& point : scan.points) {
    const RayEnd end = rays.end(point);
    walk_ray(rays.origin, end.at, [&](VoxelIndex v) { masks.free(v); });
    if (end.hit) masks.hit(voxel_of(end.at, 1.0));
    if (masks.overflowed()) return;
  }
}

}  // namespace

Result<CheckedScan> checked(Scan scan, double resolution) {
  assert(resolution > 0);
  if (scan.points.size() > kMaxScanPoints) {
    return refuse(Code::kTooLarge, "cloud has over " + std::to_string(kMaxScanPoints) + " points; send it in parts");
  }
  if (!std::isfinite(scan.max_range) || scan.max_range < 0) {
    return refuse(Code::kNotFinite, "max_range is not a distance; send metres, or 0 for none");
  }
  if (scan.T_agent_sensor && !scan.T_agent_sensor->matrix().allFinite()) {
    return refuse(Code::kNotFinite, "sensor pose has a component that is not finite");
  }
  if (scan.T_agent_sensor && !in_bounds(scan.T_agent_sensor->translation(), resolution)) {
    return refuse(Code::kOutOfBounds, "sensor is not within 2^20 voxels of the agent's origin");
  }
  CheckedScan result;
  result.skipped =
      std::erase_if(scan.points, [&](const Eigen::Vector3f& p) { return !in_bounds(p.cast<double>(), resolution); });
  if (scan.T_agent_sensor) {
    const Rays rays(scan, resolution);
    const VoxelIndex origin = voxel_of(rays.origin, 1.0);
    std::uint64_t steps = 0;
    for (const Eigen::Vector3f& p : scan.points) steps += steps_between(origin, voxel_of(rays.end(p).at, 1.0));
    if (steps > kMaxScanSteps) {
      return refuse(Code::kTooLarge, "rays cross over " + std::to_string(kMaxScanSteps) +
                                         " voxels; send fewer points, or a smaller max_range");
    }
  }
  result.scan = std::move(scan);
  return result;
}

Result<std::vector<BrickIndex>> integrate(BrickMap& map, double resolution, const Scan& scan) {
  ScanMasks masks;
  trace(scan, resolution, masks);
  if (masks.overflowed()) {
    return refuse(Code::kTooLarge, "scan touches over " + std::to_string(kMaxScanBricks) +
                                       " bricks; send fewer points, or a smaller max_range");
  }
  std::vector<BrickIndex> changed;
  for (const ScanMasks::Entry& entry : masks.take_sorted()) {
    if (map.set(entry.brick, updated(map.find(entry.brick), entry))) changed.push_back(entry.brick);
  }
  return changed;
}

}  // namespace concord
