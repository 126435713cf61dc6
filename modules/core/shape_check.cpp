// What makes a shape one.
#include <cmath>
#include <string>

#include "core/shape.hpp"
#include "core/shape_pieces.hpp"

namespace concord {
namespace {

Result<void> check_point(const Eigen::Vector3d& p) {
  if (!p.allFinite()) return refuse(Code::kNotFinite, "a coordinate of the shape is not finite");
  if (p.cwiseAbs().maxCoeff() > kFarthest) {
    return refuse(Code::kOutOfBounds, "a coordinate of the shape is beyond the map; is it in metres?");
  }
  return {};
}

Result<void> check_size(double size, const char* what) {
  if (!std::isfinite(size)) return refuse(Code::kNotFinite, std::string(what) + " is not finite");
  if (size < 0) return refuse(Code::kBadShape, std::string(what) + " is negative");
  if (size > 2 * kFarthest)
    return refuse(Code::kOutOfBounds, std::string(what) + " is beyond the map's; is it in metres?");
  return {};
}

Result<void> check_points(const std::vector<Eigen::Vector3d>& points, std::size_t fewest) {
  if (points.size() < fewest) {
    return refuse(Code::kBadShape, "needs at least " + std::to_string(fewest) + " points");
  }
  if (points.size() > kMaxShapePoints) {
    return refuse(Code::kTooLarge, "has over " + std::to_string(kMaxShapePoints) + " points; draw it in parts");
  }
  for (const Eigen::Vector3d& p : points) {
    if (auto fine = check_point(p); !fine) return fine;
  }
  return {};
}

Result<void> check_range(double low, double high) {
  if (low <= high) return {};
  return refuse(Code::kBadShape, "has its lowest corner above its highest; exchange them");
}

Result<void> fine(const Result<std::vector<Triangle>>& triangles) {
  if (!triangles) return tl::unexpected(triangles.error());
  return {};
}

struct Check {
  Result<void> operator()(const VoxelList& list) const {
    if (!std::isfinite(list.resolution)) return refuse(Code::kNotFinite, "the voxels' resolution is not finite");
    if (list.resolution <= 0) return refuse(Code::kBadResolution, "the voxels' resolution must be above 0");
    for (const VoxelBox& box : list.boxes) {
      if (!in_bounds(box.min) || !in_bounds(box.max)) {
        return refuse(Code::kOutOfBounds, "voxel index is beyond +-" + std::to_string(kMaxVoxel));
      }
      if (box.min.x > box.max.x || box.min.y > box.max.y || box.min.z > box.max.z) return check_range(1, 0);
    }
    if (list.boxes.empty()) return refuse(Code::kEmpty, "no voxels selected");
    return {};
  }
  Result<void> operator()(const Line& line) const {
    return check_points(line.points, 2).and_then([&] { return check_size(line.thickness, "the thickness"); });
  }
  Result<void> operator()(const Area& area) const {
    return check_points(area.points, 3)
        .and_then([&] { return check_size(area.thickness, "the thickness"); })
        .and_then([&] { return fine(triangulate_area(area)); });
  }
  Result<void> operator()(const Box& box) const {
    return check_point(box.min).and_then([&] { return check_point(box.max); }).and_then([&]() -> Result<void> {
      for (int i = 0; i < 3; ++i) {
        if (auto range = check_range(box.min[i], box.max[i]); !range) return range;
      }
      return {};
    });
  }
  Result<void> operator()(const OrientedBox& box) const {
    const Eigen::Matrix3d R = box.T_frame_box.linear();
    if (!R.allFinite()) return refuse(Code::kNotFinite, "the box's rotation is not finite");
    if (!is_rotation(R)) {
      return refuse(Code::kBadTransform, "the box's transform is no rotation and translation");
    }
    Result<void> result = check_point(box.T_frame_box.translation());
    for (int i = 0; i < 3 && result; ++i) result = check_size(box.size[i], "an edge of the box");
    return result;
  }
  Result<void> operator()(const Prism& prism) const {
    return check_point({0, 0, prism.low})
        .and_then([&] {
          return check_point({0, 0, prism.high});
        })
        .and_then([&] { return check_range(prism.low, prism.high); })
        .and_then([&] { return fine(triangulate(prism.points)); });
  }
};

}  // namespace

Result<void> check(const Shape& shape) { return std::visit(Check{}, shape); }
Result<void> check(const Volume& volume) { return std::visit(Check{}, volume); }

}  // namespace concord
