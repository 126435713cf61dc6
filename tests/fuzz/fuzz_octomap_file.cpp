#include "octomap_checks.hpp"

using namespace concord;

/// A file as it stands, or (first byte odd) a tree behind a header that is right but for its number of nodes.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  ByteSpan in(data + 1, size - 1);
  Bytes file;
  if ((data[0] & 1) != 0) {
    const auto format = (data[0] & 2) != 0 ? OctomapFormat::kBinary : OctomapFormat::kFull;
    append_octomap_header(file, {format, read_le<std::uint16_t>(in).value_or(0), 0.05});
  }
  file.insert(file.end(), in.begin(), in.end());
  fuzz::check_import(read_octomap_file(file, std::nullopt, fuzz::kSmallLimits));
  fuzz::check_import(read_octomap_file(file, 0.05, fuzz::kSmallLimits));
  return 0;
}
