#include "merge/region.hpp"

#include <algorithm>

namespace concord {
namespace {

constexpr double kTouch = 1e-6;  ///< metres: nearer is the same place

}  // namespace

Eigen::AlignedBox3d bounds_in_map(const Volume& volume, const Transform& T_map_frame) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& corner : corners(volume)) box.extend(T_map_frame * corner);
  return box;
}

TurnedBox turned_bounds(const Volume& volume, const Transform& T_map_frame) {
  if (const auto* box = std::get_if<OrientedBox>(&volume)) {
    return {(T_map_frame * box->T_frame_box).inverse(), {-0.5 * box->size, 0.5 * box->size}};
  }
  return {T_map_frame.inverse(), bounds_in_map(volume, Transform::Identity())};
}

bool overlap(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b) {
  for (int axis = 0; axis < 3; ++axis) {
    const double shared = std::min(a.max()[axis], b.max()[axis]) - std::max(a.min()[axis], b.min()[axis]);
    const bool flat = std::min(a.sizes()[axis], b.sizes()[axis]) < kTouch;
    if (shared < (flat ? -kTouch : kTouch)) return false;
  }
  return true;
}

}  // namespace concord
