#pragma once

#include "core/shape.hpp"

namespace concord {

/// How LabelRequest::Op::kTouch says where: a millimetre about the point.
[[nodiscard]] inline Box touch_at(const Eigen::Vector3d& p) {
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.0005);
  return {p - half, p + half};
}

}  // namespace concord
