#include "merge/map_store.hpp"

#include <algorithm>

#include "core/octomap_writer.hpp"
#include "core/requests.hpp"
#include "store/whole_file.hpp"

namespace concord {

Result<std::int64_t> MapStore::save(const BrickMap& map, double resolution, const std::string& name,
                                    const std::string& format, bool overwrite) const {
  const std::filesystem::path file = folder_ / (name + "." + format);
  std::error_code error;
  if (!overwrite && std::filesystem::exists(file, error)) {
    return refuse(Code::kExists,
                  "a map " + name + "." + format + " exists; ask to overwrite it, or choose another name");
  }
  const auto bytes =
      write_octomap_file(map, resolution, format == "ot" ? OctomapFormat::kFull : OctomapFormat::kBinary);
  if (!bytes) return tl::unexpected(bytes.error());
  std::filesystem::create_directories(folder_, error);
  if (error) return refuse(Code::kIo, folder_.string() + ": " + error.message());
  if (auto written = write_whole_file(file, *bytes); !written) return tl::unexpected(written.error());
  return static_cast<std::int64_t>(bytes->size());
}

Result<std::vector<std::pair<std::string, std::int64_t>>> MapStore::list() const {
  std::vector<std::pair<std::string, std::int64_t>> files;
  std::error_code error;
  for (auto it = std::filesystem::directory_iterator(folder_, error);
       !error && it != std::filesystem::directory_iterator(); it.increment(error)) {
    const std::string extension = it->path().extension();
    if ((extension != ".bt" && extension != ".ot") || !is_name(it->path().stem().string())) continue;
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
