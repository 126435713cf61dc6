#include "semantic/assets/gltf_store.hpp"

#include <Eigen/Geometry>

#include "semantic/models/gltf.hpp"
#include "semantic/models/model_file.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace fs = std::filesystem;

GltfStore::Source GltfStore::source_of(const Asset& asset) const {
  std::error_code none;
  return {fs::last_write_time(folder_ / asset.file, none), asset.unit};
}

const GltfStore::Tried* GltfStore::tried(const Asset& asset) const {
  const auto it = tried_.find(asset.name);
  return it != tried_.end() && it->second.source == source_of(asset) ? &it->second : nullptr;
}

Eigen::Vector3d GltfStore::size_of(const Asset& asset) const {
  const Tried* made = tried(asset);
  return made != nullptr ? made->size : Eigen::Vector3d::Zero();
}

std::int64_t GltfStore::bytes_of(const Asset& asset) const {
  if (tried(asset) == nullptr) return 0;
  std::error_code error;
  const auto size = fs::file_size(file_of(asset), error);
  return error ? 0 : static_cast<std::int64_t>(size);
}

Result<void> GltfStore::write_next(const std::map<std::string, Asset>& assets) {
  for (const auto& [name, asset] : assets) {
    if (tried(asset) != nullptr) continue;
    Tried& made = tried_[name] = {source_of(asset)};
    std::error_code none;
    fs::remove(file_of(asset), none);  // of what the model was
    fs::create_directories(folder_ / "gltf", none);
    const auto mesh = read_model_file(folder_ / asset.file);
    if (!mesh) return tl::unexpected(mesh.error());
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : mesh->vertices) box.extend(p);
    if (!box.isEmpty()) made.size = box.sizes() * asset.unit;
    return write_whole_file(file_of(asset), write_glb(*mesh, asset.unit));
  }
  return {};
}

}  // namespace concord
