#include "semantic/gltf_store.hpp"

#include "semantic/gltf.hpp"
#include "semantic/model_file.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace fs = std::filesystem;

GltfStore::Source GltfStore::source_of(const Asset& asset) const {
  std::error_code none;
  return {fs::last_write_time(folder_ / asset.file, none), asset.unit};
}

std::int64_t GltfStore::bytes_of(const Asset& asset) const {
  const auto tried = tried_.find(asset.name);
  if (tried == tried_.end() || tried->second != source_of(asset)) return 0;
  std::error_code error;
  const auto size = fs::file_size(file_of(asset), error);
  return error ? 0 : static_cast<std::int64_t>(size);
}

Result<void> GltfStore::write_next(const std::map<std::string, Asset>& assets) {
  for (const auto& [name, asset] : assets) {
    const Source source = source_of(asset);
    const auto tried = tried_.find(name);
    if (tried != tried_.end() && tried->second == source) continue;
    tried_[name] = source;
    std::error_code none;
    fs::remove(file_of(asset), none);  // of what the model was
    fs::create_directories(folder_ / "gltf", none);
    const auto mesh = read_model_file(folder_ / asset.file);
    if (!mesh) return tl::unexpected(mesh.error());
    return write_whole_file(file_of(asset), write_glb(*mesh, asset.unit));
  }
  return {};
}

}  // namespace concord
