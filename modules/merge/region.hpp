#pragma once

#include <Eigen/Geometry>

#include "core/shape.hpp"

namespace concord {

/// The box along the map's axes around a volume, metres. @pre check(volume).
[[nodiscard]] Eigen::AlignedBox3d bounds_in_map(const Volume& volume, const Transform& T_map_frame);

/// A box, turned as the volume is, around it.
struct TurnedBox {
  Transform T_box_map = Transform::Identity();
  Eigen::AlignedBox3d box;
};
[[nodiscard]] TurnedBox turned_bounds(const Volume& volume, const Transform& T_map_frame);

/// Whether two boxes share volume; a common face is not shared, but a flat box lies in what it touches.
[[nodiscard]] bool overlap(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b);

}  // namespace concord
