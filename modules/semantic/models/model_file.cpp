#include "semantic/models/model_file.hpp"

#include <algorithm>
#include <fstream>

#include "semantic/models/model_reader.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostSiblings = 256;  ///< that are watched: a hostile file may name any number
constexpr std::size_t kMostName = 255;      ///< bytes, of those

Result<Bytes> read_file(const fs::path& file) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  if (error) return refuse(Code::kNotFound, file.string() + ": " + error.message());
  if (size > kMaxModelBytes) return refuse(Code::kTooLarge, file.string() + " is too large; simplify the model");
  std::ifstream in(file, std::ios::binary);
  Bytes bytes(size);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size))) {
    return refuse(Code::kIo, "cannot read " + file.string());
  }
  return bytes;
}

bool leads_out(const fs::path& name) {
  return name.is_absolute() || std::ranges::find(name, fs::path("..")) != name.end();
}

/// Refuses what leads out of the folder, by its name or by a link.
Result<Bytes> read_sibling(const fs::path& folder, const std::string& name) {
  std::error_code error;
  const fs::path top = fs::canonical(folder, error);
  const fs::path real = error || leads_out(name) ? fs::path() : fs::canonical(folder / name, error);
  const auto [end_of_top, ignored] = std::mismatch(top.begin(), top.end(), real.begin(), real.end());
  if (real.empty() || error || end_of_top != top.end()) {
    return refuse(Code::kNotFound, name + " is not in the model's folder");
  }
  return read_file(real);
}

void watch(const fs::path& folder, const std::string& name, std::vector<FileState>& siblings) {
  if (siblings.size() >= kMostSiblings || name.size() > kMostName || leads_out(name)) return;
  const bool is_new = std::ranges::find(siblings, name, &FileState::name) == siblings.end();
  if (is_new) siblings.push_back(state_of(folder, name));
}

}  // namespace

FileState state_of(const fs::path& folder, const std::string& name) {
  std::error_code none;
  const auto written = fs::last_write_time(folder / name, none).time_since_epoch().count();
  const auto bytes = fs::file_size(folder / name, none);
  return {name, none ? 0 : static_cast<std::int64_t>(written), none ? 0 : static_cast<std::int64_t>(bytes)};
}

Result<TriangleMesh> read_model_file_here(const fs::path& file, std::vector<FileState>* siblings) {
  std::string kind = file.extension().string();
  if (!kind.empty()) kind.erase(0, 1);
  std::ranges::transform(kind, kind.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (!is_model_kind(kind)) {
    return refuse(Code::kBadName, file.string() + ": a model must be .glb, .gltf, .obj, .stl or .ply");
  }
  const auto bytes = read_file(file);
  if (!bytes) return tl::unexpected(bytes.error());
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  auto mesh = read_model(*bytes, kind, [&](const std::string& name) {
    if (siblings != nullptr) watch(folder, name, *siblings);
    return read_sibling(folder, name);
  });
  if (!mesh) return refuse(mesh.error().code, file.string() + ": " + mesh.error().message);
  return mesh;
}

Result<TriangleMesh> read_model_file(const fs::path& file) {
  auto child = ChildWork::begin([&] { return read_model_file_here(file).map(to_bytes); });
  if (!child) return tl::unexpected(child.error());
  const auto reply = child->wait();
  if (reply) return mesh_from_bytes(*reply);
  const std::string& words = reply.error().message;
  if (words.starts_with(file.string())) return tl::unexpected(reply.error());
  return refuse(reply.error().code, file.string() + ": " + words);
}

}  // namespace concord
