#include "core/voxel_boxes.hpp"

#include <algorithm>
#include <string>

namespace concord {
namespace {

/// Joins neighbours in the list that `grows(a, b)` says are one box when a is stretched to b's end.
template <class Grows>
std::vector<VoxelBox> joined(const std::vector<VoxelBox>& boxes, Grows grows) {
  std::vector<VoxelBox> out;
  for (const VoxelBox& box : boxes) {
    if (!out.empty() && grows(out.back(), box)) {
      out.back().max = box.max;
    } else {
      out.push_back(box);
    }
  }
  return out;
}

}  // namespace

std::vector<VoxelBox> to_boxes(std::span<const VoxelIndex> voxels) {
  std::vector<VoxelBox> boxes;
  boxes.reserve(voxels.size());
  for (const VoxelIndex v : voxels) boxes.push_back({v, v});
  boxes = joined(boxes, [](const VoxelBox& a, const VoxelBox& b) {
    return a.max.x == b.min.x && a.max.y == b.min.y && a.max.z + 1 == b.min.z;
  });
  boxes = joined(boxes, [](const VoxelBox& a, const VoxelBox& b) {
    return a.max.x == b.min.x && a.max.y + 1 == b.min.y && a.min.z == b.min.z && a.max.z == b.max.z;
  });
  // Rectangles at one x stand together; the same rectangle at the next x follows it only after a sort.
  std::sort(boxes.begin(), boxes.end(), [](const VoxelBox& a, const VoxelBox& b) {
    const auto key = [](const VoxelBox& box) {
      return std::array{box.min.y, box.max.y, box.min.z, box.max.z, box.min.x};
    };
    return key(a) < key(b);
  });
  return joined(boxes, [](const VoxelBox& a, const VoxelBox& b) {
    return a.max.x + 1 == b.min.x && a.min.y == b.min.y && a.max.y == b.max.y && a.min.z == b.min.z &&
           a.max.z == b.max.z;
  });
}

Result<std::vector<VoxelIndex>> expand(std::span<const VoxelBox> boxes, std::int64_t most) {
  std::int64_t total = 0;
  for (const VoxelBox& box : boxes) {
    if (!in_bounds(box.min) || !in_bounds(box.max)) {
      return refuse(Code::kOutOfBounds, "voxel index is beyond +-" + std::to_string(kMaxVoxel));
    }
    if (box.min.x > box.max.x || box.min.y > box.max.y || box.min.z > box.max.z) {
      return refuse(Code::kBadRequest, "a box has its lowest corner above its highest");
    }
    const auto side = [](std::int32_t low, std::int32_t high) { return std::int64_t{high} - low + 1; };
    const std::int64_t area = side(box.min.x, box.max.x) * side(box.min.y, box.max.y);
    if (area > most || (total += area * side(box.min.z, box.max.z)) > most) {
      return refuse(Code::kTooLarge, "over " + std::to_string(most) + " voxels in one request; split it");
    }
  }
  if (total == 0) return refuse(Code::kEmpty, "no voxels selected");
  std::vector<VoxelIndex> voxels;
  voxels.reserve(static_cast<std::size_t>(total));
  for (const VoxelBox& box : boxes) {
    for (std::int32_t x = box.min.x; x <= box.max.x; ++x)
      for (std::int32_t y = box.min.y; y <= box.max.y; ++y)
        for (std::int32_t z = box.min.z; z <= box.max.z; ++z) voxels.push_back({x, y, z});
  }
  std::sort(voxels.begin(), voxels.end());
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  return voxels;
}

}  // namespace concord
