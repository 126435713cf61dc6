#include "cli/arguments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace concord {
namespace {

/// A corner this close to a voxel's face (in voxels) lies on it: 1.15 / 0.05 is not exactly 23.
constexpr double kOnFace = 1e-6;

struct Layers {
  double first, last;
};

Layers layers_of(double a, double b, double resolution) {
  const double low = std::min(a, b) / resolution, high = std::max(a, b) / resolution;
  const double first = std::floor(low + kOnFace);
  return {first, std::max(first, std::ceil(high - kOnFace) - 1)};
}

}  // namespace

Result<std::vector<double>> parse_numbers(const std::string& text, std::size_t count) {
  std::string spaced = text;
  std::ranges::replace(spaced, ',', ' ');
  std::istringstream in(spaced);
  std::vector<double> numbers;
  for (std::string word; in >> word;) {
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (end == word.c_str() || *end != '\0') return refuse(Code::kMalformed, "'" + word + "' is not a number");
    if (!std::isfinite(value)) return refuse(Code::kNotFinite, "'" + word + "' is not a finite number");
    numbers.push_back(value);
  }
  if (numbers.size() != count) {
    return refuse(Code::kMalformed,
                  "'" + text + "' must hold " + std::to_string(count) + " numbers, quoted as one argument");
  }
  return numbers;
}

Result<Eigen::Vector2d> parse_point(const std::string& text) {
  return parse_numbers(text, 2).map([](const auto& n) { return Eigen::Vector2d(n[0], n[1]); });
}

Result<Transform> parse_transform(const std::string& text) {
  return parse_numbers(text, 7).and_then([](const auto& n) {
    return make_transform({n[0], n[1], n[2]}, {n[3], n[4], n[5], n[6]});
  });
}

Result<VoxelBox> voxel_box(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double resolution) {
  std::array<Layers, 3> axis{};
  for (Eigen::Index i = 0; i < 3; ++i) {
    Layers& layers = axis[static_cast<std::size_t>(i)];
    layers = layers_of(a[i], b[i], resolution);
    if (layers.first < -kMaxVoxel || layers.last >= kMaxVoxel) {
      return refuse(Code::kOutOfBounds, "the box lies beyond the map; give metres in the map frame");
    }
  }
  const auto index = [&](double Layers::*side) {
    return VoxelIndex{static_cast<std::int32_t>(axis[0].*side), static_cast<std::int32_t>(axis[1].*side),
                      static_cast<std::int32_t>(axis[2].*side)};
  };
  return VoxelBox{index(&Layers::first), index(&Layers::last)};
}

Result<VoxelBox> parse_box(const std::string& text, double resolution) {
  return parse_numbers(text, 6).and_then([&](const auto& n) {
    return voxel_box({n[0], n[1], n[2]}, {n[3], n[4], n[5]}, resolution);
  });
}

}  // namespace concord
