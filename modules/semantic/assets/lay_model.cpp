#include "semantic/assets/lay_model.hpp"

#include "core/label_corrections.hpp"
#include "core/map_archive_fields.hpp"
#include "semantic/models/model_file.hpp"
#include "semantic/models/solid_voxels.hpp"

namespace concord {
namespace {

/// Counted before they are listed: a large cube is few bricks and very many voxels.
Result<BrickMasks> solid(const TriangleMesh& mesh, const Transform& T_map_asset, double unit, double resolution) {
  auto voxels = voxelize(mesh, {T_map_asset, unit}, resolution, Fill::kSolid);
  if (!voxels) return tl::unexpected(voxels.error());
  if (voxels->surface.count() + voxels->interior.count() > kMaxLabelVoxels) {
    return refuse(Code::kTooLarge, "the model would fill over " + std::to_string(kMaxLabelVoxels) + " voxels");
  }
  voxels->surface.insert(voxels->interior);
  return std::move(voxels->surface);
}

Result<ObjectFit> fitted(const TriangleMesh& mesh, const ModelToLay& model, double resolution) {
  const auto points = surface_points(mesh, model.unit, resolution);
  if (!points) return tl::unexpected(points.error());
  BrickMasks present;
  if (model.T_map_present) {
    auto voxels = solid(mesh, *model.T_map_present, model.unit, resolution);
    if (!voxels) return tl::unexpected(voxels.error());
    present = std::move(*voxels);
  }
  return fit_object(*points, model.surface(present), resolution, model.T_map_asset);
}

}  // namespace

Result<LaidModel> lay_model(const ModelToLay& model, double resolution) {
  const auto mesh = read_model_file_here(model.file);
  if (!mesh) return tl::unexpected(mesh.error());
  LaidModel laid;
  laid.fit.T_map_model = model.T_map_asset;
  if (model.surface) {
    const auto fit = fitted(*mesh, model, resolution);
    if (!fit) return tl::unexpected(fit.error());
    laid.fit = *fit;
  }
  auto voxels = solid(*mesh, laid.fit.T_map_model, model.unit, resolution);
  if (!voxels) return tl::unexpected(voxels.error());
  laid.voxels = std::move(*voxels);
  return laid;
}

Bytes to_bytes(const LaidModel& laid) {
  Bytes out;
  archive::append_transform(out, laid.fit.T_map_model);
  for (const double value : {laid.fit.matched, laid.fit.rms, laid.fit.shift, laid.fit.turn}) {
    archive::append_real(out, value);
  }
  for (const auto& [index, mask] : laid.voxels.sorted()) {
    for (const std::int32_t at : {index.x, index.y, index.z}) append_le(out, at);
    for (const std::uint64_t word : mask) append_le(out, word);
  }
  return out;
}

Result<LaidModel> laid_model_from_bytes(ByteSpan bytes) {
  archive::FieldReader in(bytes);
  LaidModel laid;
  laid.fit.T_map_model = archive::read_transform(in);
  laid.fit.matched = in.real();
  laid.fit.rms = in.real();
  laid.fit.shift = in.real();
  laid.fit.turn = in.real();
  while (in.ok() && !in.rest().empty()) {
    BrickIndex index;
    for (std::int32_t* at : {&index.x, &index.y, &index.z}) *at = in.integer<std::int32_t>();
    VoxelMask mask{};
    for (std::uint64_t& word : mask) word = in.integer<std::uint64_t>();
    if (in.ok()) laid.voxels.insert(index, mask);
  }
  if (!in.ok() || !is_rotation(laid.fit.T_map_model.linear())) {
    return refuse(Code::kMalformed, "the model cannot be read");  // it wrecked the other process
  }
  return laid;
}

}  // namespace concord
