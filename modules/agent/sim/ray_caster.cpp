#include "agent/sim/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace concord {
namespace {

constexpr double kCell = 0.4;     // metres; measured best of 0.2 to 1.0
constexpr double kMargin = 1e-6;  // solids are listed a little beyond their bounds, so that rounding cannot skip one
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The stretch of a ray inside an axis-parallel box about the origin; empty if it misses.
struct Stretch {
  double enter = -kInfinity, leave = kInfinity;

  void clip(double origin, double direction, double low, double high) {
    if (direction == 0) {
      if (origin < low || origin > high) leave = -kInfinity;
      return;
    }
    const double a = (low - origin) / direction, b = (high - origin) / direction;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
};

}  // namespace

std::optional<double> RayCaster::enters(const Ray& ray, const Box& box) {
  const Eigen::Vector3d o = ray.origin - box.centre;
  const Eigen::Vector3d& d = ray.direction;
  Stretch stretch;
  stretch.clip(o.z(), d.z(), -box.half.z(), box.half.z());
  stretch.clip(box.cos * o.x() + box.sin * o.y(), box.cos * d.x() + box.sin * d.y(), -box.half.x(), box.half.x());
  stretch.clip(box.cos * o.y() - box.sin * o.x(), box.cos * d.y() - box.sin * d.x(), -box.half.y(), box.half.y());
  if (stretch.enter > stretch.leave || stretch.enter < 0) return std::nullopt;
  return stretch.enter;
}

std::optional<double> enters(const Ray& ray, const Solid& solid) {
  return RayCaster::enters(
      ray, RayCaster::Box{solid.centre, solid.half, std::cos(solid.yaw), std::sin(solid.yaw), solid.material});
}

RayCaster::RayCaster(const World& world) {
  Eigen::AlignedBox3d all;
  for (const Solid& s : world.solids) {
    solids_.push_back({s.centre, s.half, std::cos(s.yaw), std::sin(s.yaw), s.material});
    all.extend(bounds(s));
  }
  low_ = all.min() - Eigen::Vector3d::Constant(2 * kMargin);
  for (int axis = 0; axis < 3; ++axis) {
    size_[axis] = static_cast<int>(std::floor((all.max()[axis] + 2 * kMargin - low_[axis]) / kCell)) + 1;
    high_[axis] = low_[axis] + size_[axis] * kCell;
  }

  std::vector<std::vector<std::uint32_t>> lists(static_cast<std::size_t>(size_[0]) * size_[1] * size_[2]);
  for (std::uint32_t i = 0; i < solids_.size(); ++i) {
    const Eigen::AlignedBox3d box = bounds(world.solids[i]);
    std::array<int, 3> from{}, to{};
    for (int axis = 0; axis < 3; ++axis) {
      from[axis] = static_cast<int>((box.min()[axis] - kMargin - low_[axis]) / kCell);
      to[axis] = static_cast<int>((box.max()[axis] + kMargin - low_[axis]) / kCell);
    }
    for (int z = from[2]; z <= to[2]; ++z) {
      for (int y = from[1]; y <= to[1]; ++y) {
        for (int x = from[0]; x <= to[0]; ++x) lists[(std::size_t(z) * size_[1] + y) * size_[0] + x].push_back(i);
      }
    }
  }
  first_.push_back(0);
  for (const auto& list : lists) {
    listed_.insert(listed_.end(), list.begin(), list.end());
    first_.push_back(static_cast<std::uint32_t>(listed_.size()));
  }
}

void RayCaster::test_cell(std::size_t cell, const Ray& ray, Glass glass, std::optional<Hit>& nearest) const {
  for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
    const Box& box = solids_[listed_[i]];
    if (box.material == Material::kGlass && glass == Glass::kLetsThrough) continue;
    const std::optional<double> distance = enters(ray, box);
    if (!distance) continue;
    if (!nearest || *distance < nearest->distance || (*distance == nearest->distance && listed_[i] < nearest->solid)) {
      nearest = Hit{*distance, listed_[i]};
    }
  }
}

std::optional<Hit> RayCaster::cast(const Ray& ray, double range, Glass glass) const {
  Stretch inside;
  for (int axis = 0; axis < 3; ++axis) inside.clip(ray.origin[axis], ray.direction[axis], low_[axis], high_[axis]);
  double at = std::max(inside.enter, 0.0);
  const double end = std::min(inside.leave, range);
  if (at > end) return std::nullopt;

  std::array<int, 3> cell{}, step{};
  std::array<double, 3> next{}, stride{};  // distances at which the ray crosses into the next cell, per axis
  for (int axis = 0; axis < 3; ++axis) {
    const double o = ray.origin[axis], d = ray.direction[axis];
    cell[axis] = std::clamp(static_cast<int>((o + at * d - low_[axis]) / kCell), 0, size_[axis] - 1);
    step[axis] = d > 0 ? 1 : d < 0 ? -1 : 0;
    stride[axis] = d == 0 ? kInfinity : kCell / std::abs(d);
    const double border = low_[axis] + (cell[axis] + (d > 0 ? 1 : 0)) * kCell;
    next[axis] = d == 0 ? kInfinity : (border - o) / d;
  }

  std::optional<Hit> nearest;
  while (at <= end) {
    test_cell((static_cast<std::size_t>(cell[2]) * size_[1] + cell[1]) * size_[0] + cell[0], ray, glass, nearest);
    const int axis = next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : (next[1] <= next[2] ? 1 : 2);
    at = next[axis];
    if (nearest && nearest->distance < at - kMargin) break;
    cell[axis] += step[axis];
    if (cell[axis] < 0 || cell[axis] >= size_[axis]) break;
    next[axis] += stride[axis];
  }
  return nearest && nearest->distance <= range ? nearest : std::nullopt;
}

}  // namespace concord
