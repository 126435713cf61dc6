#include "semantic/models/solid_voxels.hpp"

#include "semantic/models/triangle_voxels.hpp"

namespace concord {

Result<ModelVoxels> voxelize(const TriangleMesh& mesh, const ModelPlacement& placement, double resolution, Fill fill) {
  if (const auto fine = check(mesh); !fine) return tl::unexpected(fine.error());
  const auto snapped = snap(mesh, placement, resolution);
  if (!snapped) return tl::unexpected(snapped.error());
  auto surface = surface_of(*snapped);
  if (!surface) return tl::unexpected(surface.error());
  ModelVoxels out;
  out.watertight = is_watertight(*snapped);
  if (fill == Fill::kSolid) {
    auto inside = out.watertight ? inside_by_parity(*snapped) : not_reached_from_outside(*surface);
    if (!inside) return tl::unexpected(inside.error());
    out.interior = std::move(*inside);
    out.interior.erase(*surface);
  }
  out.surface = std::move(*surface);
  if (out.surface.count() + out.interior.count() > kMaxModelVoxels) {
    return refuse(Code::kTooLarge, "the model would fill over " + std::to_string(kMaxModelVoxels) + " voxels");
  }
  return out;
}

}  // namespace concord
