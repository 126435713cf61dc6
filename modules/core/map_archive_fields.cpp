#include "core/map_archive_fields.hpp"

#include "core/voxel_boxes.hpp"

namespace concord::archive {
namespace {

static_assert(kMaxVoxel == 1 << 15, "voxels are written in 16 bits");
constexpr std::size_t kBoxBytes = 6 * 2;

VoxelIndex read_voxel(FieldReader& in) {
  VoxelIndex v;
  v.x = in.integer<std::int16_t>();
  v.y = in.integer<std::int16_t>();
  v.z = in.integer<std::int16_t>();
  return v;
}

}  // namespace

void append_transform(Bytes& out, const Transform& T) {
  for (int row = 0; row < 3; ++row) append_vector<3>(out, T.linear().row(row).transpose());
  append_vector<3>(out, T.translation());
}

Transform read_transform(FieldReader& in) {
  Transform T = Transform::Identity();
  for (int row = 0; row < 3; ++row) T.linear().row(row) = read_vector<3>(in).transpose();
  T.translation() = read_vector<3>(in);
  return T;
}

void append_voxels(Bytes& out, const std::vector<VoxelIndex>& voxels) {
  const std::vector<VoxelBox> boxes = to_boxes(voxels);
  append_le(out, static_cast<std::uint32_t>(boxes.size()));
  for (const VoxelBox& box : boxes) {
    for (const VoxelIndex v : {box.min, box.max}) {
      for (const std::int32_t c : {v.x, v.y, v.z}) append_le(out, static_cast<std::int16_t>(c));
    }
  }
}

Result<std::vector<VoxelIndex>> read_voxels(FieldReader& in, std::uint64_t most) {
  const auto count = in.integer<std::uint32_t>();
  if (!in.ok() || count > in.rest().size() / kBoxBytes) return malformed("a correction is cut short; save it again");
  if (count == 0) return std::vector<VoxelIndex>();
  std::vector<VoxelBox> boxes(count);
  for (VoxelBox& box : boxes) {
    box.min = read_voxel(in);
    box.max = read_voxel(in);
  }
  auto voxels = expand(boxes, static_cast<std::int64_t>(most));
  if (!voxels && voxels.error().code == Code::kTooLarge) {
    return refuse(Code::kTooLarge, "map file: its corrections hold more voxels than can be");
  }
  if (!voxels || to_boxes(*voxels) != boxes) return malformed("a correction's voxels are none; save it again");
  return voxels;
}

}  // namespace concord::archive
