#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/error.hpp"
#include "core/transform.hpp"
#include "core/voxel_boxes.hpp"

namespace concord {

/// Of a robot, metres. 0 would mean "the site file's" on the wire: who wants that gives none.
inline const CLI::Range kRobotRadius(0.001, 10.0);

/// Quoted arguments: numbers with spaces or commas between them, metres, map frame unless said otherwise.
/// Refused: another count of numbers than expected (kMalformed), NaN or infinity (kNotFinite).
[[nodiscard]] Result<std::vector<double>> parse_numbers(const std::string& text, std::size_t count);
[[nodiscard]] Result<Eigen::Vector2d> parse_point(const std::string& text);
/// "x y z qx qy qz qw"; see make_transform for what is refused.
[[nodiscard]] Result<Transform> parse_transform(const std::string& text);

/// The voxels that share volume with a box given by two opposite corners, metres; a side without thickness takes the
/// layer of voxels that begins there or holds it. So a pane drawn thinner than a voxel is still there.
/// Refused: a box beyond the lattice (kOutOfBounds). @pre both corners are finite.
[[nodiscard]] Result<VoxelBox> voxel_box(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double resolution);
/// The same for "x0 y0 z0 x1 y1 z1".
[[nodiscard]] Result<VoxelBox> parse_box(const std::string& text, double resolution);

}  // namespace concord
