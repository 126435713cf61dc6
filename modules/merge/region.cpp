#include "merge/region.hpp"

#include <algorithm>

namespace concord {
namespace {

constexpr double kTouch = 1e-6;  ///< metres: nearer is the same place

struct Corners {
  const Transform& T_map_frame;
  Eigen::AlignedBox3d& out;

  void operator()(const Box& box) const { add({box.min, box.max}, T_map_frame); }
  void operator()(const OrientedBox& box) const {
    add({-0.5 * box.size, 0.5 * box.size}, T_map_frame * box.T_frame_box);
  }
  void operator()(const Prism& prism) const {
    for (const Eigen::Vector2d& p : prism.points) {
      for (const double z : {prism.low, prism.high}) out.extend(T_map_frame * Eigen::Vector3d(p.x(), p.y(), z));
    }
  }
  void add(const Eigen::AlignedBox3d& box, const Transform& T) const {
    for (int i = 0; i < 8; ++i) out.extend(T * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
  }
};

}  // namespace

Eigen::AlignedBox3d bounds_in_map(const Volume& volume, const Transform& T_map_frame) {
  Eigen::AlignedBox3d box;
  std::visit(Corners{T_map_frame, box}, volume);
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
