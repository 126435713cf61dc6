#include "planner/footprint/footprint_text.hpp"

#include <charconv>
#include <cmath>
#include <string>

namespace concord {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

Error malformed(const char* what) { return {Code::kMalformed, what}; }

/// Decimal numbers with any of `between` between them; no more than `most`.
Result<std::vector<double>> read_numbers(std::string_view text, std::string_view between, std::size_t most) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t first = text.find_first_not_of(between);
    if (first == text.npos) return numbers;
    text.remove_prefix(first);
    if (numbers.size() == most) return refuse(Code::kTooLarge, "too many numbers");
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string_view rest(end, static_cast<std::size_t>(text.data() + text.size() - end));
    if (error == std::errc::result_out_of_range || !std::isfinite(value))
      return refuse(Code::kNotFinite, "a number is none, or too large");
    if (error != std::errc() || (!rest.empty() && between.find(rest.front()) == between.npos))
      return refuse(Code::kMalformed, "what should be a number is not");
    numbers.push_back(value);
    text = rest;
  }
}

Result<Footprint> read_rectangle(std::string_view length, std::string_view width) {
  const auto x = read_numbers(length, kBlanks, 1);
  const auto y = read_numbers(width, kBlanks, 1);
  if (!x) return tl::unexpected(x.error());
  if (!y) return tl::unexpected(y.error());
  if (x->size() != 1 || y->size() != 1) return tl::unexpected(malformed("a rectangle is LENGTHxWIDTH, as 1.2x0.8"));
  if (x->front() <= 0 || y->front() <= 0) return refuse(Code::kBadShape, "length and width must be over 0");
  return make_rectangle(x->front(), y->front());
}

}  // namespace

Result<Footprint> read_footprint(std::string_view text) {
  if (text.size() > kMaxFootprintText) return refuse(Code::kTooLarge, "a footprint's text is shorter than 8 kB");
  if (const std::size_t by = text.find('x'); by != text.npos) {
    return read_rectangle(text.substr(0, by), text.substr(by + 1));
  }
  std::vector<Eigen::Vector2d> corners;
  while (true) {
    const std::size_t end = text.find(',');
    const auto corner = read_numbers(text.substr(0, end), kBlanks, 2);
    if (!corner) return tl::unexpected(corner.error());
    if (corner->size() != 2) {
      return tl::unexpected(malformed("a footprint is LENGTHxWIDTH, as 1.2x0.8, or corners \"x y, x y, x y\""));
    }
    if (corners.size() == Footprint::kMaxVertices) return refuse(Code::kTooLarge, "a footprint has 64 corners at most");
    corners.emplace_back(corner->front(), corner->back());
    if (end == text.npos) return Footprint::make(std::move(corners));
    text.remove_prefix(end + 1);
  }
}

Result<Pose> read_pose(std::string_view text) {
  const auto numbers = read_numbers(text, " \t\r\n,", 3);
  if (!numbers && numbers.error().code == Code::kNotFinite) return tl::unexpected(numbers.error());
  if (!numbers || numbers->size() < 2) {
    return tl::unexpected(malformed("a pose is \"x y yaw\" or \"x y\", metres and radians, quoted as one argument"));
  }
  return Pose{{(*numbers)[0], (*numbers)[1]}, numbers->size() == 3 ? (*numbers)[2] : 0.0};
}

}  // namespace concord
