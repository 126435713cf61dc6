#include "must.hpp"
#include "semantic/models/solid_voxels.hpp"

using namespace concord;

/// A mesh as the reading process hands it over, and triangles anywhere: voxels without a crash, surface apart from
/// inside.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)mesh_from_bytes({data, size});
  ByteSpan in(data, size);
  TriangleMesh mesh;
  while (in.size() >= 9 && mesh.triangles.size() < 40) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int corner = 0; corner < 3; ++corner) {
      Eigen::Vector3d p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = *read_le<std::int8_t>(in) / 16.0;
      mesh.vertices.push_back(p);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  const auto voxels = voxelize(mesh, {}, 0.25, Fill::kSolid);
  if (!voxels) return 0;
  fuzz::must(!voxels->surface.empty());
  for (const VoxelIndex v : voxels->interior.voxels()) fuzz::must(!voxels->surface.contains(v));
  return 0;
}
