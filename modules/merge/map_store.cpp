#include "merge/map_store.hpp"

#include <algorithm>

#include "core/requests.hpp"
#include "store/whole_file.hpp"

namespace concord {

Result<void> MapStore::check(const std::string& name, const std::string& format, bool overwrite) const {
  std::error_code error;
  const auto status = std::filesystem::status(path_of(name, format), error);
  if (!std::filesystem::exists(status)) return {};
  if (!std::filesystem::is_regular_file(status)) {
    return refuse(Code::kIo, path_of(name, format).string() + ": is no regular file");
  }
  if (overwrite) return {};
  return refuse(Code::kExists, "a map " + name + "." + format + " exists; ask to overwrite it, or choose another name");
}

Result<void> MapStore::save(const std::string& name, const Files& files) const {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) return refuse(Code::kIo, folder_.string() + ": " + error.message());
  std::vector<FileToWrite> all;
  for (const auto& [format, bytes] : files) all.push_back({path_of(name, format), bytes});
  return write_whole_files(all);
}

bool MapStore::contains(const std::string& name, const std::string& format) const {
  std::error_code error;
  return std::filesystem::exists(path_of(name, format), error);
}

Result<Bytes> MapStore::read(const std::string& name, const std::string& format, std::uint64_t most) const {
  return read_whole_file(path_of(name, format), most);
}

Result<MapStore::Version> MapStore::version(const std::string& name, const std::string& format) const {
  const std::filesystem::path path = path_of(name, format);
  std::error_code error;
  Version version;
  version.bytes = std::filesystem::file_size(path, error);
  if (!error) version.written = std::filesystem::last_write_time(path, error);
  if (!error) return version;
  if (error == std::errc::no_such_file_or_directory) return refuse(Code::kNotFound, path.string() + " is not there");
  return refuse(Code::kIo, path.string() + ": " + error.message());
}

Result<std::vector<std::pair<std::string, std::int64_t>>> MapStore::list() const {
  std::vector<std::pair<std::string, std::int64_t>> files;
  std::error_code error;
  for (auto it = std::filesystem::directory_iterator(folder_, error);
       !error && it != std::filesystem::directory_iterator(); it.increment(error)) {
    const std::string extension = it->path().extension();
    const bool is_map = extension == ".bt" || extension == ".ot" || extension == ".concord";
    if (!is_map || !is_name(it->path().stem().string())) continue;
    std::error_code vanished;
    const auto size = it->file_size(vanished);
    if (!vanished) files.emplace_back(it->path().filename(), static_cast<std::int64_t>(size));
  }
  if (error && error != std::errc::no_such_file_or_directory)
    return refuse(Code::kIo, folder_.string() + ": " + error.message());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace concord
