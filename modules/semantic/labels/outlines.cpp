#include "semantic/labels/outlines.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace concord {

void Outline::add(const Outline& other) {
  for (std::size_t i = 0; i < reach.size(); ++i) reach[i] = std::max(reach[i], other.reach[i]);
  lowest = std::min(lowest, other.lowest);
  highest = std::max(highest, other.highest);
  sum_x += other.sum_x;
  sum_y += other.sum_y;
  count += other.count;
}

const std::array<Eigen::Vector2d, Outline::kSides>& outline_directions() {
  static const auto kDirections = [] {
    std::array<Eigen::Vector2d, Outline::kSides> out;
    for (int i = 0; i < Outline::kSides; ++i) {
      const double angle = 2 * M_PI * i / Outline::kSides;
      out[static_cast<std::size_t>(i)] = {std::cos(angle), std::sin(angle)};
    }
    return out;
  }();
  return kDirections;
}

Outline outline_of(std::span<const VoxelIndex> voxels, double resolution) {
  Outline out;
  const auto& directions = outline_directions();
  for (const VoxelIndex v : voxels) {
    const Eigen::Vector2d p = centre_of(v, resolution).head<2>();
    for (std::size_t i = 0; i < directions.size(); ++i) out.reach[i] = std::max(out.reach[i], p.dot(directions[i]));
    out.lowest = std::min(out.lowest, v.z);
    out.highest = std::max(out.highest, v.z);
    out.sum_x += v.x;
    out.sum_y += v.y;
  }
  out.count = static_cast<std::int64_t>(voxels.size());
  return out;
}

void Outlines::set(BrickIndex index, InBrick now) {
  const auto known = by_brick_.find(index);
  if (known == by_brick_.end() ? now.empty() : known->second == now) return;
  if (known != by_brick_.end()) {
    for (const auto& [of, outline] : known->second) {
      bricks_[of].erase(index);
      stale_.insert(of);
    }
  }
  for (const auto& [of, outline] : now) {
    bricks_[of].insert(index);
    stale_.insert(of);
  }
  if (now.empty()) {
    by_brick_.erase(index);
  } else {
    by_brick_[index] = std::move(now);
  }
}

void Outlines::clear() {
  for (const auto& [of, outline] : whole_) stale_.insert(of);
  by_brick_.clear();
  bricks_.clear();
}

const std::map<InstanceId, Outline>& Outlines::all() {
  for (const InstanceId of : std::exchange(stale_, {})) {
    const auto bricks = bricks_.find(of);
    if (bricks == bricks_.end() || bricks->second.empty()) {
      whole_.erase(of);
      bricks_.erase(of);
      continue;
    }
    Outline all;
    for (const BrickIndex index : bricks->second) all.add(by_brick_.at(index).at(of));
    whole_[of] = all;
  }
  return whole_;
}

}  // namespace concord
