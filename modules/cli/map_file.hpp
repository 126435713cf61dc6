#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "core/brick_map.hpp"
#include "core/error.hpp"
#include "core/octomap_reader.hpp"

namespace concord {

/// Reads a `.bt` or `.ot` file, resampled if a resolution is given. Refused: see read_octomap_file; kNotFound, kIo.
[[nodiscard]] Result<OctomapImport> load_map(const std::filesystem::path& file,
                                             std::optional<double> resolution = std::nullopt);

/// Writes `.bt` or `.ot`, by the name's extension. Refused: any other extension (kBadName), kIo. A failure leaves what
/// stood there as it was.
[[nodiscard]] Result<void> save_map(const std::filesystem::path& file, const BrickMap& map, double resolution);

/// Writes a file that is there whole or not at all. Refused: see write_whole_file.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& file, std::string_view text);

}  // namespace concord
