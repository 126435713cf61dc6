#include <array>

#include "octomap_checks.hpp"

using namespace concord;

/// The payload of an octomap message: the first byte chooses its format and resolutions.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto format = (data[0] & 1) != 0 ? OctomapFormat::kBinary : OctomapFormat::kFull;
  constexpr std::array<double, 8> kResolutions{0.05, 0.1, 0.025, 0.075, 0.0499, 0.0333, 5.0, 0.0001};
  const double target = kResolutions[data[0] >> 1 & 7];
  const ByteSpan tree(data + 1, size - 1);
  fuzz::check_import(read_octomap_data(tree, format, 0.05, std::nullopt, fuzz::kSmallLimits));
  fuzz::check_import(read_octomap_data(tree, format, 0.05, target, fuzz::kSmallLimits));
  return 0;
}
