#include "semantic/assets/gltf_store.hpp"

#include <yaml-cpp/yaml.h>
#include <Eigen/Geometry>

#include "core/map_archive_fields.hpp"
#include "semantic/models/gltf.hpp"
#include "semantic/models/model_file.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

const std::string kNotes = "made.yaml";

}  // namespace

GltfStore::GltfStore(fs::path folder) : folder_(std::move(folder)) { read_notes(); }

/// Notes that are none are as good as no notes: all is made again.
void GltfStore::read_notes() {
  std::error_code error;
  const fs::path file = folder_ / "gltf" / kNotes;
  if (!fs::exists(file, error)) return;
  try {
    for (const auto& entry : YAML::LoadFile(file.string())) {
      const YAML::Node& of = entry.second;
      Made made;
      made.source = {of["file"].as<std::string>(), of["written"].as<std::int64_t>(), of["bytes"].as<std::int64_t>(),
                     of["unit"].as<double>()};
      for (int axis = 0; axis < 3; ++axis) made.size[axis] = of["size"][axis].as<double>();
      made_[entry.first.as<std::string>()] = made;
    }
  } catch (const YAML::Exception&) {
    made_.clear();
  }
}

Result<void> GltfStore::write_notes() const {
  YAML::Emitter out;
  out.SetDoublePrecision(17);
  out << YAML::BeginMap;
  for (const auto& [name, made] : made_) {
    if (!made.is_readable) continue;
    out << YAML::Key << name << YAML::Value << YAML::Flow << YAML::BeginMap;
    out << YAML::Key << "file" << YAML::Value << YAML::DoubleQuoted << made.source.file;
    out << YAML::Key << "written" << YAML::Value << made.source.written;
    out << YAML::Key << "bytes" << YAML::Value << made.source.bytes;
    out << YAML::Key << "unit" << YAML::Value << made.source.unit;
    out << YAML::Key << "size" << YAML::Value << YAML::Flow << YAML::BeginSeq << made.size.x() << made.size.y()
        << made.size.z() << YAML::EndSeq << YAML::EndMap;
  }
  out << YAML::EndMap;
  const auto* text = reinterpret_cast<const std::uint8_t*>(out.c_str());
  return write_whole_file(folder_ / "gltf" / kNotes, {text, out.size()});
}

GltfStore::Source GltfStore::source_of(const Asset& asset) const {
  const fs::path file = folder_ / asset.file;
  std::error_code none;
  const auto written = fs::last_write_time(file, none).time_since_epoch().count();
  const auto bytes = fs::file_size(file, none);
  return {asset.file, written, none ? 0 : static_cast<std::int64_t>(bytes), asset.unit};
}

const GltfStore::Made* GltfStore::made_of(const Asset& asset) const {
  const auto it = made_.find(asset.name);
  return it != made_.end() && it->second.source == source_of(asset) ? &it->second : nullptr;
}

Eigen::Vector3d GltfStore::size_of(const Asset& asset) const {
  const Made* made = made_of(asset);
  return made != nullptr ? made->size : Eigen::Vector3d::Zero();
}

std::int64_t GltfStore::bytes_of(const Asset& asset) const {
  const Made* made = made_of(asset);
  if (made == nullptr || !made->is_readable) return 0;
  std::error_code error;
  const auto size = fs::file_size(file_of(asset.name), error);
  return error ? 0 : static_cast<std::int64_t>(size);
}

const Asset* GltfStore::next(const std::map<std::string, Asset>& assets) const {
  for (const auto& [name, asset] : assets) {
    const Made* made = made_of(asset);
    if (made == nullptr || (made->is_readable && bytes_of(asset) == 0)) return &asset;
  }
  return nullptr;
}

ChildWork::Work GltfStore::work_for(const Asset& asset) const {
  return [source = folder_ / asset.file, to = file_of(asset.name), unit = asset.unit]() -> Result<Bytes> {
    const auto mesh = read_model_file_here(source);
    if (!mesh) return tl::unexpected(mesh.error());
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : mesh->vertices) box.extend(p);
    std::error_code error;
    fs::create_directories(to.parent_path(), error);
    if (const auto written = write_whole_file(to, write_glb(*mesh, unit)); !written) {
      return tl::unexpected(written.error());
    }
    Bytes size;
    archive::append_vector<3>(size, box.sizes() * unit);
    return size;
  };
}

Result<void> GltfStore::note(const std::string& name, const Source& source, const Result<Bytes>& reply) {
  if (!reply && reply.error().code == Code::kIo) return tl::unexpected(reply.error());  // the disk may have room again
  Made& made = made_[name] = {source};
  if (reply) {
    archive::FieldReader in(*reply);
    made.size = archive::read_vector<3>(in);
    if (in.ok() && made.size.allFinite()) return write_notes();
  }
  made.size.setZero();
  made.is_readable = false;
  std::error_code none;
  std::filesystem::remove(file_of(name), none);  // of what the model was
  return reply ? refuse(Code::kMalformed, name + ": the model cannot be read")
               : Result<void>(tl::unexpected(reply.error()));
}

Result<void> GltfStore::keep_only(const std::map<std::string, Asset>& assets) {
  const auto is_gone = [&](const auto& entry) { return !assets.contains(entry.first); };
  std::error_code none;
  for (const auto& entry : made_) {
    if (is_gone(entry)) fs::remove(file_of(entry.first), none);
  }
  return std::erase_if(made_, is_gone) > 0 ? write_notes() : Result<void>();
}

}  // namespace concord
