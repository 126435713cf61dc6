#include "server/static_files.hpp"

#include <algorithm>
#include <cctype>

#include "store/whole_file.hpp"

namespace concord::hmd {
namespace {

std::string type_of(const std::filesystem::path& file) {
  static const std::map<std::string, const char*> kTypes = {{".html", "text/html; charset=utf-8"},
                                                            {".js", "text/javascript; charset=utf-8"},
                                                            {".css", "text/css; charset=utf-8"},
                                                            {".json", "application/json"},
                                                            {".svg", "image/svg+xml"},
                                                            {".png", "image/png"},
                                                            {".ico", "image/x-icon"},
                                                            {".wasm", "application/wasm"},
                                                            {".glb", "model/gltf-binary"},
                                                            {".gltf", "model/gltf+json"},
                                                            {".map", "application/json"},
                                                            {".webmanifest", "application/manifest+json"}};
  const auto it = kTypes.find(file.extension().string());
  return it != kTypes.end() ? it->second : "application/octet-stream";
}

bool is_plain(const std::string& name) {
  return !name.empty() && name[0] != '.' && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '.' || c == '_' || c == '-';
  });
}

}  // namespace

Result<void> StaticFiles::add(const std::filesystem::path& folder, const std::string& prefix) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_directory(folder, error)) return refuse(Code::kNotFound, "no folder " + folder.string());
  fs::recursive_directory_iterator it(folder, error), end;
  for (; !error && it != end; it.increment(error)) {
    if (!it->is_regular_file(error)) continue;
    const fs::path path = fs::relative(it->path(), folder, error);
    if (error || !std::all_of(path.begin(), path.end(), [](const fs::path& part) { return is_plain(part.string()); }))
      continue;
    auto bytes = read_whole_file(it->path(), kMaxBytes - bytes_);
    if (!bytes) return tl::unexpected(std::move(bytes.error()));
    bytes_ += bytes->size();
    if (files_.size() >= kMaxFiles) return refuse(Code::kTooLarge, folder.string() + " holds too many files");
    add(prefix + path.generic_string(),
        {type_of(path), std::make_shared<const std::string>(bytes->begin(), bytes->end()), {}});
  }
  if (error) return refuse(Code::kIo, folder.string() + ": " + error.message());
  return {};
}

std::shared_ptr<const StaticFiles::File> StaticFiles::model(std::string_view name) const {
  const std::filesystem::path file(name);
  if (!is_plain(std::string(name)) || file.extension() != ".glb") return nullptr;
  std::error_code error;
  const auto size = std::filesystem::is_regular_file(models_ / file, error)
                        ? std::filesystem::file_size(models_ / file, error)
                        : kMaxModelBytes + 1;
  if (error || size > kMaxModelBytes) return nullptr;
  return std::make_shared<const File>(File{type_of(file), nullptr, models_ / file});
}

std::shared_ptr<const StaticFiles::File> StaticFiles::find(std::string_view target) const {
  const std::string_view path = target.substr(0, target.find('?'));
  if (!models_prefix_.empty() && path.starts_with(models_prefix_)) return model(path.substr(models_prefix_.size()));
  const auto it = files_.find(path == "/" ? "/index.html" : path);
  return it != files_.end() ? it->second : nullptr;
}

}  // namespace concord::hmd
