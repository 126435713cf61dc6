#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Core>

namespace concord::bench {

/// Points of a .pcd or .ply; a mesh is sampled every `spacing` metres. Throws where it cannot be read.
[[nodiscard]] std::vector<Eigen::Vector3f> read_cloud(const std::filesystem::path& file, double spacing);

}  // namespace concord::bench
