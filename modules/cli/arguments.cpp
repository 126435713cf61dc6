#include "cli/arguments.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace concord {
namespace {

Result<std::vector<double>> all_numbers(const std::string& text) {
  std::string spaced = text;
  std::ranges::replace(spaced, ',', ' ');
  std::istringstream in(spaced);
  std::vector<double> numbers;
  for (std::string word; in >> word;) {
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    const bool is_hexadecimal = word.find_first_of("xX") != word.npos;  // "0x10" is a slip of "0 10"
    if (end == word.c_str() || *end != '\0' || is_hexadecimal)
      return refuse(Code::kMalformed, "'" + word + "' is not a number");
    if (!std::isfinite(value)) return refuse(Code::kNotFinite, "'" + word + "' is not a finite number");
    numbers.push_back(value);
  }
  return numbers;
}

template <class Point>
Result<std::vector<Point>> points(const std::string& text) {
  constexpr std::size_t kNumbers = Point::RowsAtCompileTime;
  const auto numbers = all_numbers(text);
  if (!numbers) return tl::unexpected(numbers.error());
  if (numbers->empty() || numbers->size() % kNumbers != 0) {
    return refuse(Code::kMalformed, "'" + text + "' must hold " + (kNumbers == 2 ? "two" : "three") +
                                        " numbers a point, quoted as one argument");
  }
  std::vector<Point> points;
  for (std::size_t i = 0; i < numbers->size(); i += kNumbers) points.emplace_back(numbers->data() + i);
  return points;
}

}  // namespace

Result<std::vector<double>> parse_numbers(const std::string& text, std::size_t count) {
  auto numbers = all_numbers(text);
  if (numbers && numbers->size() != count) {
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

Result<Box> parse_box(const std::string& text) {
  return parse_numbers(text, 6).map([](const auto& n) {
    const Eigen::Vector3d a(n[0], n[1], n[2]), b(n[3], n[4], n[5]);
    return Box{a.cwiseMin(b), a.cwiseMax(b)};
  });
}

Result<std::vector<Eigen::Vector3d>> parse_points(const std::string& text) { return points<Eigen::Vector3d>(text); }

Result<std::vector<Eigen::Vector2d>> parse_points_2d(const std::string& text) { return points<Eigen::Vector2d>(text); }

Result<Eigen::Vector3d> parse_vector(const std::string& text) {
  return parse_numbers(text, 3).map([](const auto& n) { return Eigen::Vector3d(n[0], n[1], n[2]); });
}

Result<OrientedBox> parse_oriented_box(const std::string& text) {
  return parse_numbers(text, 10).and_then([](const auto& n) {
    return make_transform({n[0], n[1], n[2]}, {n[3], n[4], n[5], n[6]}).map([&](const Transform& T_frame_box) {
      return OrientedBox{T_frame_box, {n[7], n[8], n[9]}};
    });
  });
}

}  // namespace concord
