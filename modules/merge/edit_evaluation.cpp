#include "merge/edit_evaluation.hpp"

#include <algorithm>
#include <iterator>

#include "core/voxel_runs.hpp"

namespace concord {
namespace {

/// By how many voxels of the map.
Result<VoxelIndex> whole_voxels(const Eigen::Vector3d& move, const Transform& T_map_frame, double resolution) {
  const Eigen::Vector3d steps = (T_map_frame.linear() * move / resolution).array().round();
  if (!(steps.cwiseAbs().maxCoeff() <= 2.0 * kMaxVoxel)) {
    return refuse(Code::kOutOfBounds, "this moves voxels beyond the map's bounds");
  }
  const VoxelIndex by{static_cast<std::int32_t>(steps.x()), static_cast<std::int32_t>(steps.y()),
                      static_cast<std::int32_t>(steps.z())};
  if (by == VoxelIndex{}) return refuse(Code::kBadRequest, "this moves by less than half a voxel");
  return by;
}

Result<std::vector<VoxelIndex>> shifted(const std::vector<VoxelIndex>& voxels, VoxelIndex by) {
  std::vector<VoxelIndex> out;
  out.reserve(voxels.size());
  for (const VoxelIndex v : voxels) {
    out.push_back({v.x + by.x, v.y + by.y, v.z + by.z});
    if (!in_bounds(out.back())) return refuse(Code::kOutOfBounds, "this moves voxels beyond the map's bounds");
  }
  return out;
}

Result<Correction::Edit> evaluate_move(const EditRequest& request, std::vector<VoxelIndex> selected,
                                       const Transform& T_map_frame, const BrickMap& map, double resolution) {
  const auto by = whole_voxels(request.move, T_map_frame, resolution);
  if (!by) return tl::unexpected(by.error());
  std::erase_if(selected, [&](VoxelIndex v) { return !is_occupied(map.at(v)); });
  if (selected.empty()) return refuse(Code::kEmpty, "nothing is occupied there");
  auto reached = shifted(selected, *by);
  if (!reached) return tl::unexpected(reached.error());
  const bool meets = std::ranges::any_of(
      *reached, [&](VoxelIndex v) { return is_occupied(map.at(v)) && !std::ranges::binary_search(selected, v); });
  if (meets) return refuse(Code::kCollision, "it would meet what is there; delete that first, or move elsewhere");
  Correction::Edit edit{request.op, std::move(*reached), {}};
  std::ranges::set_difference(selected, edit.added, std::back_inserter(edit.deleted));
  if (edit.added.size() + edit.deleted.size() > static_cast<std::size_t>(kMaxEditVoxels)) {
    return refuse_too_many(kMaxEditVoxels);
  }
  return edit;
}

}  // namespace

Result<Correction::Edit> evaluate(const EditRequest& request, const Transform& T_map_frame, const BrickMap& map,
                                  double resolution) {
  auto selected = select(request.shape, T_map_frame, resolution, kMaxEditVoxels);
  if (!selected) return tl::unexpected(selected.error());
  switch (request.op) {
    case EditRequest::Op::kAdd: return Correction::Edit{request.op, std::move(*selected), {}};
    case EditRequest::Op::kDelete: return Correction::Edit{request.op, {}, std::move(*selected)};
    case EditRequest::Op::kMove: break;
  }
  return evaluate_move(request, std::move(*selected), T_map_frame, map, resolution);
}

}  // namespace concord
