#include "cli/map_file.hpp"

#include "cli/extension.hpp"
#include "core/octomap_writer.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

Result<OctomapFormat> format_of(const fs::path& file) {
  const std::string extension = extension_of(file);
  if (extension == ".bt") return OctomapFormat::kBinary;
  if (extension == ".ot") return OctomapFormat::kFull;
  return refuse(Code::kBadName, file.string() + " must end in .bt or .ot");
}

}  // namespace

Result<OctomapImport> load_map(const fs::path& file, std::optional<double> resolution) {
  const OctomapLimits limits;
  const Result<Bytes> bytes = read_whole_file(file, limits.bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  auto map = read_octomap_file(*bytes, resolution, limits);
  if (!map) return refuse(map.error().code, file.string() + ": " + map.error().message);
  return map;
}

Result<void> write_file(const fs::path& file, std::string_view text) {
  return write_whole_file(file, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

Result<void> save_map(const fs::path& file, const BrickMap& map, double resolution) {
  const Result<OctomapFormat> format = format_of(file);
  if (!format) return tl::unexpected(format.error());
  const Result<Bytes> bytes = write_octomap_file(map, resolution, *format);
  if (!bytes) return tl::unexpected(bytes.error());
  return write_whole_file(file, *bytes);
}

}  // namespace concord
