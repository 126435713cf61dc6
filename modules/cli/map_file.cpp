#include "cli/map_file.hpp"

#include <unistd.h>

#include <fstream>

#include "core/octomap_writer.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

Result<Bytes> read_file(const fs::path& file, std::size_t most) {
  std::error_code error;
  if (!fs::exists(file, error)) return refuse(Code::kNotFound, file.string() + " does not exist");
  if (!fs::is_regular_file(file, error)) return refuse(Code::kIo, file.string() + " is not a file");
  const std::uintmax_t size = fs::file_size(file, error);
  if (size > most) {
    return refuse(Code::kTooLarge, file.string() + " has " + std::to_string(size) + " bytes, at most " +
                                       std::to_string(most) + " are read");
  }
  Bytes bytes(static_cast<std::size_t>(size));
  std::ifstream in(file, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()))) {
    return refuse(Code::kIo, "cannot read " + file.string());
  }
  return bytes;
}

Result<OctomapFormat> format_of(const fs::path& file) {
  if (file.extension() == ".bt") return OctomapFormat::kBinary;
  if (file.extension() == ".ot") return OctomapFormat::kFull;
  return refuse(Code::kBadName, file.string() + " must end in .bt or .ot");
}

}  // namespace

Result<OctomapImport> load_map(const fs::path& file, std::optional<double> resolution) {
  const OctomapLimits limits;
  const Result<Bytes> bytes = read_file(file, limits.bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  auto map = read_octomap_file(*bytes, resolution, limits);
  if (!map) return refuse(map.error().code, file.string() + ": " + map.error().message);
  return map;
}

Result<void> write_file(const fs::path& file, std::span<const std::uint8_t> bytes) {
  const fs::path partial = file.string() + ".part" + std::to_string(getpid());
  std::ofstream out(partial, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  out.close();
  std::error_code error;
  if (out) fs::rename(partial, file, error);
  if (out && !error) return {};
  std::error_code ignored;
  fs::remove(partial, ignored);
  return refuse(Code::kIo, "cannot write " + file.string() + "; check that the folder exists and has room");
}

Result<void> save_map(const fs::path& file, const BrickMap& map, double resolution) {
  const Result<OctomapFormat> format = format_of(file);
  if (!format) return tl::unexpected(format.error());
  const Result<Bytes> bytes = write_octomap_file(map, resolution, *format);
  if (!bytes) return tl::unexpected(bytes.error());
  return write_file(file, *bytes);
}

}  // namespace concord
