#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Core>

#include "core/error.hpp"

namespace concord {

/// Of a file; larger ones are refused before memory is taken.
inline constexpr std::size_t kMaxCloudFileBytes = std::size_t{2} << 30;
inline constexpr std::size_t kMaxCloudFilePoints = 20'000'000;

/// The finite points of a `.pcd` or `.ply` file, metres, in its frame, in the order of the file; a mesh is sampled
/// every `spacing` metres, coarser where that would be over 8 million points. PCL reads them. Refused: any other
/// extension (kBadName); kNotFound, kIo; over a limit (kTooLarge); what PCL cannot read, a face that names no point of
/// the file (kMalformed); no finite point (kEmpty); a point beyond 10 km (kOutOfBounds).
[[nodiscard]] Result<std::vector<Eigen::Vector3f>> read_cloud(const std::filesystem::path& file, double spacing);

}  // namespace concord
