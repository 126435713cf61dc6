#include "semantic/assets/gltf_store.hpp"

#include <algorithm>

#include <yaml-cpp/yaml.h>
#include <Eigen/Geometry>

#include "core/map_archive_fields.hpp"
#include "core/text.hpp"
#include "semantic/models/gltf.hpp"
#include "semantic/models/model_file.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

const std::string kNotes = "made.yaml";

FileState state_in(const YAML::Node& node) {
  return {node["file"].as<std::string>(), node["written"].as<std::int64_t>(), node["bytes"].as<std::int64_t>()};
}

void emit(YAML::Emitter& out, const FileState& state) {
  out << YAML::Key << "file" << YAML::Value << YAML::DoubleQuoted << state.name;
  out << YAML::Key << "written" << YAML::Value << state.written;
  out << YAML::Key << "bytes" << YAML::Value << state.bytes;
}

void append(Bytes& out, const FileState& state) {
  archive::append_text(out, state.name);
  append_le(out, state.written);
  append_le(out, state.bytes);
}

FileState read_state(archive::FieldReader& in) {
  FileState state;
  state.name = in.text();
  state.written = in.integer<std::int64_t>();
  state.bytes = in.integer<std::int64_t>();
  return state;
}

/// Writes the model as glTF. Returns the size of the box around it, metres.
Result<Eigen::Vector3d> convert(const fs::path& from, const fs::path& to, double unit,
                                std::vector<FileState>& siblings) {
  const auto mesh = read_model_file_here(from, &siblings);
  if (!mesh) return tl::unexpected(mesh.error());
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : mesh->vertices) box.extend(p);
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  const auto written = write_whole_file(to, write_glb(*mesh, unit));
  return written.map([&] { return Eigen::Vector3d(box.sizes() * unit); });
}

/// A reply: why it is no model, or nothing; its size; what it names.
void append_outcome(Bytes& out, const Result<Eigen::Vector3d>& size) {
  append_le(out, size ? std::uint8_t{0} : static_cast<std::uint8_t>(size.error().code));
  archive::append_text(out, size ? std::string() : cut_to(size.error().message, 255));
  archive::append_vector<3>(out, size.value_or(Eigen::Vector3d::Zero()));
}

Result<Eigen::Vector3d> read_outcome(archive::FieldReader& in) {
  const auto code = in.integer<std::uint8_t>();
  const std::string why = in.text();
  const Eigen::Vector3d size = archive::read_vector<3>(in);
  if (!in.ok() || !size.allFinite() || code > static_cast<std::uint8_t>(Code::kIo)) {
    return refuse(Code::kMalformed, "the model cannot be read");
  }
  if (!why.empty()) return refuse(static_cast<Code>(code), why);
  return size;
}

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
      made.source = {state_in(of), of["unit"].as<double>()};
      for (const YAML::Node& sibling : of["siblings"]) made.siblings.push_back(state_in(sibling));
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
    emit(out, made.source.file);
    out << YAML::Key << "siblings" << YAML::Value << YAML::BeginSeq;
    for (const FileState& sibling : made.siblings) {
      out << YAML::BeginMap;
      emit(out, sibling);
      out << YAML::EndMap;
    }
    out << YAML::EndSeq;
    out << YAML::Key << "unit" << YAML::Value << made.source.unit;
    out << YAML::Key << "size" << YAML::Value << YAML::Flow << YAML::BeginSeq << made.size.x() << made.size.y()
        << made.size.z() << YAML::EndSeq << YAML::EndMap;
  }
  out << YAML::EndMap;
  const auto* text = reinterpret_cast<const std::uint8_t*>(out.c_str());
  return write_whole_file(folder_ / "gltf" / kNotes, {text, out.size()});
}

GltfStore::Source GltfStore::source_of(const Asset& asset) const { return {state_of(folder_, asset.file), asset.unit}; }

const GltfStore::Made* GltfStore::made_of(const Asset& asset) const {
  const auto it = made_.find(asset.name);
  if (it == made_.end() || it->second.source != source_of(asset)) return nullptr;
  const fs::path beside = (folder_ / asset.file).parent_path();
  const bool are_as_read = std::ranges::all_of(
      it->second.siblings, [&](const FileState& sibling) { return state_of(beside, sibling.name) == sibling; });
  return are_as_read ? &it->second : nullptr;
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

const Asset* GltfStore::next(const std::map<std::string, Asset>& assets, std::int64_t now) const {
  for (const auto& [name, asset] : assets) {
    if (const auto failed = failed_.find(name); failed != failed_.end() && now - failed->second < kPause) continue;
    const Made* made = made_of(asset);
    if (made == nullptr || (made->is_readable && bytes_of(asset) == 0)) return &asset;
  }
  return nullptr;
}

ChildWork::Work GltfStore::work_for(const Asset& asset) const {
  return [source = folder_ / asset.file, to = file_of(asset.name), unit = asset.unit]() -> Result<Bytes> {
    std::vector<FileState> siblings;
    const auto size = convert(source, to, unit, siblings);
    if (!size && size.error().code == Code::kIo) return tl::unexpected(size.error());
    Bytes reply;
    append_outcome(reply, size);
    for (const FileState& sibling : siblings) append(reply, sibling);
    return reply;
  };
}

Result<void> GltfStore::note(const std::string& name, const Source& source, const Result<Bytes>& reply,
                             std::int64_t now) {
  failed_.erase(name);
  if (!reply && reply.error().code == Code::kIo) {  // it may be readable, or the disk have room, later
    failed_[name] = now;
    return tl::unexpected(reply.error());
  }
  archive::FieldReader in(reply ? ByteSpan(*reply) : ByteSpan());
  const Result<Eigen::Vector3d> size = reply ? read_outcome(in) : tl::unexpected(reply.error());
  Made& made = made_[name];
  made = Made();
  made.source = source;
  while (in.ok() && !in.rest().empty()) made.siblings.push_back(read_state(in));
  made.is_readable = size.has_value();
  made.size = size.value_or(Eigen::Vector3d::Zero());
  if (size) return write_notes();
  std::error_code none;
  std::filesystem::remove(file_of(name), none);  // of what the model was
  return tl::unexpected(size.error());
}

Result<void> GltfStore::keep_only(const std::map<std::string, Asset>& assets) {
  const auto is_gone = [&](const auto& entry) { return !assets.contains(entry.first); };
  std::error_code none;
  for (const auto& entry : made_) {
    if (is_gone(entry)) fs::remove(file_of(entry.first), none);
  }
  std::erase_if(failed_, is_gone);
  return std::erase_if(made_, is_gone) > 0 ? write_notes() : Result<void>();
}

}  // namespace concord
