#pragma once

#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "core/error.hpp"
#include "core/shape.hpp"
#include "core/transform.hpp"

namespace concord {

/// Of a robot, metres. 0 would mean "the site file's" on the wire: who wants that gives none.
inline const CLI::Range kRobotRadius(0.001, 10.0);

/// Quoted arguments: numbers with spaces or commas between them, metres, map frame unless said otherwise.
/// Refused: another count of numbers than expected (kMalformed), NaN or infinity (kNotFinite).
[[nodiscard]] Result<std::vector<double>> parse_numbers(const std::string& text, std::size_t count);
[[nodiscard]] Result<Eigen::Vector2d> parse_point(const std::string& text);
/// "x y z qx qy qz qw"; see make_transform for what is refused.
[[nodiscard]] Result<Transform> parse_transform(const std::string& text);

/// "x0 y0 z0 x1 y1 z1": two opposite corners, in any order.
[[nodiscard]] Result<Box> parse_box(const std::string& text);
/// "x y z x y z ...": at least one point.
[[nodiscard]] Result<std::vector<Eigen::Vector3d>> parse_points(const std::string& text);
/// "x y x y ...": at least one point.
[[nodiscard]] Result<std::vector<Eigen::Vector2d>> parse_points_2d(const std::string& text);
/// "x y z".
[[nodiscard]] Result<Eigen::Vector3d> parse_vector(const std::string& text);
/// "x y z qx qy qz qw sx sy sz": centre, rotation and whole edges.
[[nodiscard]] Result<OrientedBox> parse_oriented_box(const std::string& text);

}  // namespace concord
